// SPDX-License-Identifier: Apache-2.0
#include <raycontact/scene.h>

#include "broadphase/sweep_and_prune.h"
#include "executor/float_environment.h"
#include "pose_fault.h"
#include "shape/shape_data.h"
#include "step.h"

#include <raycontact/error.h>

#include <algorithm>
#include <chrono>

namespace raycontact {

namespace {

void refuse_faulty(const Pose& pose, BodyId body) {
    if (const char* fault = pose_fault(pose)) throw InputError("body " + std::to_string(body) + ": " + fault);
}

} // namespace

struct Scene::State {
    struct Body {
        std::shared_ptr<const Shape> shape; ///< empty once removed
        Pose pose;
    };

    explicit State(const Settings& settings) : narrow(settings) {}

    const Body& existing(BodyId body) const {
        if (body >= bodies.size() || !bodies[body].shape)
            throw InputError("body " + std::to_string(body) + " is not in the scene; add() gives the ids that are");
        return bodies[body];
    }

    /// Threads sleep while a solver runs; of a few pairs they take no part.
    void call_threads(std::size_t pair_count) {
        if (pair_count > 256) narrow.executor().wake();
    }

    void place_bodies() {
        if (narrow.shapes().pack()) {
            for (BodyId id = 0; id < bodies.size(); ++id)
                if (bodies[id].shape) placed[id].shape_index = narrow.shapes().index_of(bodies[id].shape.get());
        }
        for (BodyId id = 0; id < bodies.size(); ++id) {
            if (!bodies[id].shape) continue;
            placed[id].pose = bodies[id].pose;
            placed[id].centred = centred_pose(*bodies[id].shape, bodies[id].pose);
        }
    }

    // How far beyond its box an open mesh can be reached: the farthest any ray of this scene goes.
    double reach_into_open() const {
        double reach = 0;
        for (const Body& body : bodies) {
            if (!body.shape) continue;
            const ShapeData& shape = body.shape->data();
            reach = std::max(reach, shape.exit_max > 0 ? double(shape.exit_max) : shape.diagonal);
        }
        return reach;
    }

    void find_pairs() {
        double reach = -1;
        boxes.clear();
        for (BodyId id = 0; id < bodies.size(); ++id) {
            if (!bodies[id].shape) continue;
            const Shape& shape = *bodies[id].shape;
            const bool open = shape.data().header.closed == 0;
            if (open && reach < 0) reach = reach_into_open();
            boxes.push_back(world_box(id, shape.box_min(), shape.box_max(), bodies[id].pose, open ? reach : 0));
        }
        broad.find_pairs(boxes, pairs);
    }

    // As a caller may give them: in any order, either way round, more than once.
    void take_pairs(std::span<const Pair> given) {
        const bool same = std::equal(given.begin(), given.end(), pairs.begin(), pairs.end());
        if (same && !removed) return; // they were looked through in an earlier step
        for (const Pair& pair : given) {
            existing(pair.first);
            existing(pair.second);
            if (pair.first == pair.second)
                throw InputError("body " + std::to_string(pair.first)
                                 + " is paired with itself; pairs need two bodies");
        }
        pairs.assign(given.begin(), given.end());
        for (Pair& pair : pairs)
            if (pair.first > pair.second) std::swap(pair.first, pair.second);
        if (!std::is_sorted(pairs.begin(), pairs.end())) std::sort(pairs.begin(), pairs.end());
        pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
        removed = false;
    }

    NarrowPhase narrow;
    SweepAndPrune broad;
    std::vector<Body> bodies;
    std::vector<PlacedBody> placed;
    std::vector<WorldBox> boxes;
    std::vector<Pair> pairs;
    std::vector<Contact> contacts;
    StepStats stats;
    bool removed = false; ///< a body, since pairs were looked through
};

Scene::Scene(const Settings& settings) {
    check_settings(settings);
    state_ = std::make_unique<State>(settings);
}
Scene::~Scene() = default;

BodyId Scene::add(std::shared_ptr<const Shape> shape, const Pose& pose) {
    const auto id = static_cast<BodyId>(state_->bodies.size());
    if (!shape) throw InputError("body " + std::to_string(id) + ": the shape is null");
    refuse_faulty(pose, id);
    state_->narrow.shapes().add(shape);
    state_->placed.resize(id); // should an earlier add have failed half-way
    state_->placed.push_back({shape.get(), state_->narrow.shapes().index_of(shape.get()), pose, pose});
    state_->bodies.push_back({std::move(shape), pose});
    return id;
}

void Scene::remove(BodyId body) {
    state_->existing(body);
    state_->narrow.shapes().remove(state_->bodies[body].shape.get());
    state_->bodies[body].shape.reset();
    state_->removed = true;
    state_->placed[body].shape = nullptr;
}

void Scene::set_pose(BodyId body, const Pose& pose) {
    state_->existing(body);
    refuse_faulty(pose, body);
    state_->bodies[body].pose = pose;
}

const Pose& Scene::pose(BodyId body) const {
    return state_->existing(body).pose;
}
void Scene::set_settings(const Settings& settings) {
    check_settings(settings);
    const Settings& old = state_->narrow.settings();
    if (settings.device != old.device || settings.threads != old.threads)
        throw InputError("device and threads are fixed when a scene is made; make another scene for others");
    state_->narrow.set_settings(settings);
}
const Settings& Scene::settings() const {
    return state_->narrow.settings();
}
const Shape& Scene::shape(BodyId body) const {
    return *state_->existing(body).shape;
}

std::uint32_t Scene::body_count() const {
    return static_cast<std::uint32_t>(std::count_if(state_->bodies.begin(), state_->bodies.end(),
                                                    [](const auto& body) { return body.shape != nullptr; }));
}

std::span<const Contact> Scene::step() {
    const FloatEnvironment environment;
    const auto start = std::chrono::steady_clock::now();
    state_->find_pairs();
    const double broad = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    state_->call_threads(state_->pairs.size());
    state_->place_bodies();
    state_->narrow.step(state_->placed, state_->pairs, state_->contacts, state_->stats);
    state_->stats.broad_ms = broad;
    return state_->contacts;
}

std::span<const Contact> Scene::step(std::span<const Pair> pairs) {
    const FloatEnvironment environment;
    state_->call_threads(pairs.size());
    state_->take_pairs(pairs);
    state_->place_bodies();
    state_->narrow.step(state_->placed, state_->pairs, state_->contacts, state_->stats);
    state_->stats.broad_ms = 0;
    return state_->contacts;
}

std::span<const Contact> Scene::contacts() const {
    return state_->contacts;
}
std::span<const LostContact> Scene::lost_contacts() const {
    return state_->narrow.lost_contacts();
}
const StepStats& Scene::stats() const {
    return state_->stats;
}
std::span<const Pair> Scene::pairs() const {
    return state_->pairs;
}

} // namespace raycontact
