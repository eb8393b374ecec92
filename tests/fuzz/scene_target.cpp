// SPDX-License-Identifier: Apache-2.0
// A sequence of what can be done to a scene, done to four at once: `certified` must find what `standard` finds, bit for
// bit, and all must refuse the same; what `iterative` and `predictive` find must name what is there.
#include "fuzz/input.h"
#include "property/shapes.h"
#include "reference/meshes.h"

#include <raycontact/error.h>
#include <raycontact/scene.h>

#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>

using namespace raycontact;

namespace {

constexpr std::array methods{Method::standard, Method::certified, Method::iterative, Method::predictive};
constexpr std::size_t most_bodies = 24;

const std::vector<std::shared_ptr<const Shape>>& shapes() {
    static const std::vector<std::shared_ptr<const Shape>> made = [] {
        std::vector<std::shared_ptr<const Shape>> all;
        for (const Mesh& mesh :
             {reference::box_mesh({0.5, 0.5, 0.5}), reference::tetrahedron_mesh(), reference::l_prism_mesh(),
              reference::frame_mesh(), reference::bumpy_octahedron_mesh(3), reference::bowl_mesh(3),
              reference::grid_box_mesh(2), reference::box_mesh({2, 2, 0.1})})
            all.push_back(Shape::make(mesh));
        return all;
    }();
    return made;
}

/// On a grid of 1/64 m, so that surfaces meet exactly now and then, or between.
Pose pose_from(fuzz::Source& source) {
    const double unit = source.below(2) == 0 ? 1.0 / 64 : 1.0 / 61;
    Vec3 at;
    at.x = unit * source.get<std::int8_t>();
    at.y = unit * source.get<std::int8_t>();
    at.z = unit * source.get<std::int8_t>();
    std::array<double, 4> q{};
    for (double& part : q) part = source.get<std::int8_t>();
    if (q == std::array<double, 4>{}) q[0] = 1;
    return pose_from_quaternion(at, q[0], q[1], q[2], q[3]);
}

/// Any bits: most are no pose.
Pose wild_pose(fuzz::Source& source) {
    Pose pose = pose_from(source);
    pose.translation.x = source.get<double>();
    if (source.below(2) == 0) pose.rotation[source.below(9)] = source.get<double>();
    return pose;
}

void change(Settings& settings, fuzz::Source& source) {
    settings.direction =
        reference::directions[source.below(static_cast<std::uint32_t>(std::size(reference::directions)))];
    settings.paper.caster = source.below(2) == 0 ? Caster::bvh : Caster::basic;
    settings.features = source.below(2) == 0 ? Features::vertices : Features::edges;
    settings.paper.skip_outside = source.below(2) == 0;
    settings.paper.cast_lost_walks = source.below(2) == 0;
    settings.paper.max_iterations = source.get<std::uint16_t>();
    settings.max_contacts_per_pair = source.below(4) == 0 ? 1 + source.below(8) : 0;
    settings.max_contacts = source.below(4) == 0 ? 1 + source.below(64) : 0;
    settings.speculative = source.below(4) == 0 ? Speculative::on : Speculative::off;
    settings.speculative_margin.reset();
    if (source.below(4) == 0) settings.speculative_margin = std::ldexp(1.0, -int(source.below(40)));
    settings.paper.displacement_threshold.reset();
    settings.paper.culling_distance.reset();
    settings.paper.distance_extension.reset();
    if (source.below(2) == 0) settings.paper.displacement_threshold = std::ldexp(1.0, -int(source.below(40)));
    if (source.below(4) == 0) settings.paper.culling_distance = source.get<float>();
    if (source.below(4) == 0) settings.paper.distance_extension = source.get<float>();
    if (source.below(4) == 0) settings.paper.confidence = source.get<float>();
}

class Four {
public:
    Four() {
        for (std::size_t i = 0; i < methods.size(); ++i) {
            settings_.method = methods[i];
            scenes_[i] = std::make_unique<Scene>(settings_);
        }
    }

    void happen(fuzz::Source& source) {
        switch (source.below(12)) {
        case 0: {
            const Pose pose = pose_from(source);
            add(source.below(8), pose);
            break;
        }
        case 1:
            if (const auto body = one(source)) all([&](Scene& scene) { scene.remove(*body); });
            break;
        case 2: {
            const Pose pose = pose_from(source);
            const bool next = source.below(4) == 0;
            if (const auto body = one(source))
                all([&](Scene& scene) { next ? scene.set_next_pose(*body, pose) : scene.set_pose(*body, pose); });
            break;
        }
        case 3: {
            const Pose pose = wild_pose(source);
            const bool next = source.below(4) == 0;
            if (const auto body = one(source))
                all([&](Scene& scene) { next ? scene.set_next_pose(*body, pose) : scene.set_pose(*body, pose); });
            break;
        }
        case 4: { // one that was never given, or is gone
            const BodyId body = source.below(2) == 0 ? source.get<BodyId>() : BodyId{source.get<std::uint8_t>()};
            all([&](Scene& scene) { scene.pose(body); });
            all([&](Scene& scene) { scene.has(body); });
            break;
        }
        case 5: {
            Settings changed = settings_;
            change(changed, source);
            const bool fits = all([&](Scene& scene) {
                Settings own = changed;
                own.method = scene.settings().method;
                scene.set_settings(own);
            });
            if (fits) settings_ = changed;
            break;
        }
        case 6: { // pairs of the caller's, right or wrong
            std::vector<Pair> pairs;
            for (std::uint32_t i = source.below(32); i > 0; --i) {
                const auto a = one(source), b = one(source);
                if (a && b) pairs.emplace_back(*a, *b);
            }
            step([&](Scene& scene) { scene.find_contacts(pairs); });
            break;
        }
        case 7:
        case 8: { // all a little, then a step
            for (const BodyId body : scenes_[0]->bodies()) {
                Pose pose = scenes_[0]->pose(body);
                const double by = std::ldexp(1.0, -4 - int(source.below(16)));
                pose.translation.x += by * source.get<std::int8_t>() / 128;
                pose.translation.z += by * source.get<std::int8_t>() / 128;
                all([&](Scene& scene) { scene.set_pose(body, pose); });
            }
            step([](Scene& scene) { scene.find_contacts(); });
            break;
        }
        default:
            step([](Scene& scene) { scene.find_contacts(); });
        }
    }

private:
    void add(std::uint32_t shape, const Pose& pose) {
        if (scenes_[0]->body_count() >= most_bodies) return;
        std::array<BodyId, methods.size()> ids{};
        std::size_t i = 0;
        if (!all([&](Scene& scene) { ids[i++] = scene.add(shapes()[shape], pose); })) return;
        for (const BodyId id : ids)
            if (id != ids[0]) fuzz::fail("scenes give different ids");
        known_.push_back(ids[0]);
    }

    /// Some body, here or gone.
    std::optional<BodyId> one(fuzz::Source& source) const {
        const auto number = source.get<std::uint8_t>();
        if (known_.empty()) return std::nullopt;
        return known_[number % known_.size()];
    }

    /// Whether all did it; all must, or none.
    template <class Act>
    bool all(Act act) {
        std::size_t done = 0;
        for (const auto& scene : scenes_) done += fuzz::taken([&] { act(*scene); });
        if (done != 0 && done != scenes_.size()) fuzz::fail("some scenes refuse what others take");
        return done != 0;
    }

    template <class Act>
    void step(Act act) {
        if (!all(act)) return;
        const Scene &standard = *scenes_[0], &certified = *scenes_[1];
        if (!reference::same_bits(standard.contacts(), certified.contacts()))
            fuzz::fail("certified has other contacts than standard");
        for (std::size_t i = 0; i < standard.contacts().size(); ++i)
            if (standard.contacts()[i].is_new != certified.contacts()[i].is_new)
                fuzz::fail("certified calls other contacts new than standard");
        if (standard.lost_contacts().size() != certified.lost_contacts().size())
            fuzz::fail("certified loses other contacts than standard");
        for (const auto& scene : scenes_) {
            check(*scene);
            scene->predictions();
        }
    }

    void check(const Scene& scene) const {
        for (const Contact& contact : scene.contacts()) {
            if (contact.body_a >= contact.body_b) fuzz::fail("a contact's bodies are not in order");
            if (!scene.has(contact.body_a) || !scene.has(contact.body_b))
                fuzz::fail("a contact of a body that is gone");
            if (!(contact.depth >= 0 || scene.settings().is_speculative()) || !std::isfinite(contact.ray_length))
                fuzz::fail("a depth that is none");
            const auto& n = contact.normal;
            const float length = n.x * n.x + n.y * n.y + n.z * n.z;
            if (!(std::fabs(length - 1) < 1e-3f)) fuzz::fail("a normal that is not of length 1");
        }
        if (scene.stats().contacts + scene.stats().contacts_speculative != scene.contacts().size())
            fuzz::fail("contacts are counted wrongly");
    }

    static Settings first_settings() {
        Settings settings;
        settings.execution.threads = 1;
        settings.execution.devices = "cpu";
        settings.features = Features::vertices;
        return settings;
    }

    Settings settings_ = first_settings();
    std::array<std::unique_ptr<Scene>, methods.size()> scenes_;
    std::vector<BodyId> known_; ///< ever given
};

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Source source({data, size});
    Four scenes;
    for (int i = 0; i < 200 && !source.empty(); ++i) scenes.happen(source);
    return 0;
}
