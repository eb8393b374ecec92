// SPDX-License-Identifier: Apache-2.0
#include "scene_state.h"

#include "contacts/predictions.h"
#include "executor/float_environment.h"
#include "pose_fault.h"
#include "read_poses.h"

#include <chrono>

namespace raycontact {

Scene::Scene(const Settings& settings) {
    check_settings(settings);
    state_ = std::make_unique<State>(settings);
}
Scene::~Scene() = default;

// NOLINTNEXTLINE(performance-unnecessary-value-param): by value in the interface; the store keeps a copy
BodyId Scene::add(std::shared_ptr<const Shape> shape, const Pose& pose) {
    State& s = *state_;
    const BodyId id = s.slots.next();
    const BodySlot slot = id.slot;
    if (!shape) throw InputError(name_of(id) + ": the shape is null");
    refuse_faulty(pose, id);
    // Room first: an add that fails then leaves no more than unused slots.
    if (slot >= s.bodies.size()) {
        s.bodies.resize(slot + std::size_t{1});
        s.user_data.resize(slot + std::size_t{1});
    }
    s.moved.make_room(slot + std::size_t{1});
    s.finder.make_room(slot + std::size_t{1});
    s.pack_shapes(); // without a step in between they would pile up
    s.narrow.parts().add_shape(shape);
    s.user_data[slot] = 0;
    s.finder.add_shape(*shape);
    s.mark(slot);
    s.bodies[slot] = {shape.get(), s.narrow.parts().index_of(shape.get()), id.generation, pose, pose, pose};
    s.count_round(*shape, 1);
    return s.slots.give();
}

void Scene::remove(BodyId body) {
    State& s = *state_;
    PlacedBody& gone = s.existing(body, "Scene::remove");
    s.finder.remove_body(body.slot, *gone.shape);
    s.set_sensor(gone, false);
    s.count_round(*gone.shape, -1);
    s.narrow.parts().remove_shape(gone.shape);
    gone.shape = nullptr;
    s.mark(body.slot);
    s.pairs.close_all_of(body.slot);
    s.given_stand = s.names_stand = false;
    s.slots.take_back(body.slot);
    s.cut_to_slots();
    try {
        s.pack_shapes();
    } catch (const std::exception&) {
        // The body is removed all the same; the next add or step packs again, and throws if it must.
    }
}

void Scene::set_pose(BodyId body, const Pose& pose) {
    PlacedBody& moved = state_->existing(body, "Scene::set_pose");
    refuse_faulty(pose, body);
    state_->set_pose(moved, body.slot, pose);
}

void Scene::set_poses(std::span<const BodyId> bodies, std::span<const Pose> poses) {
    if (bodies.size() != poses.size())
        throw InputError("Scene::set_poses: " + std::to_string(poses.size()) + " poses for "
                         + std::to_string(bodies.size()) + " bodies; give one for each");
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const char* fault = nullptr;
        if (state_->slots.is_there(bodies[i]) && (fault = pose_fault(poses[i])) == nullptr) continue;
        const std::string place = "Scene::set_poses, place " + std::to_string(i);
        state_->existing(bodies[i], place.c_str());
        throw InputError(place + ": " + name_of(bodies[i]) + ": " + fault);
    }
    for (std::size_t i = 0; i < bodies.size(); ++i)
        state_->set_pose(state_->bodies[bodies[i].slot], bodies[i].slot, poses[i]);
}

void Scene::set_poses(std::span<const BodyId> bodies, const UserMemory& poses, PoseForm form, NumberType type) {
    set_poses(bodies, read_poses(state_->narrow.parts().executor(), poses, bodies.size(), form, type));
}

const Pose& Scene::pose(BodyId body) const {
    return state_->existing(body, "Scene::pose").pose;
}
void Scene::set_next_pose(BodyId body, const Pose& pose) {
    const PlacedBody& moving = state_->existing(body, "Scene::set_next_pose");
    refuse_faulty(pose, body);
    if (state_->narrow.settings().is_speculative()) state_->next_poses.set(body.slot, moving.generation, pose);
}
void Scene::set_speculative_margin(BodyId body, std::optional<double> margin) {
    PlacedBody& own = state_->existing(body, "Scene::set_speculative_margin");
    Settings alone;
    alone.speculative_margin = margin;
    try {
        check_settings(alone);
    } catch (const InputError& error) {
        throw InputError("Scene::set_speculative_margin: " + name_of(body) + ": " + error.what());
    }
    if (own.margin == margin.value_or(-1)) return;
    own.margin = margin.value_or(-1);
    state_->mark(body.slot);
    state_->narrow.parts().forget(); // what is kept was sought by the old one
}
void Scene::set_settings(const Settings& settings) {
    check_settings(settings);
    if (settings.execution != state_->narrow.settings().execution)
        throw InputError("devices, schedule and threads are fixed when a scene is made; make another scene for others");
    state_->narrow.set_settings(settings);
    if (!settings.is_speculative()) {
        state_->next = {};
        state_->next_poses.forget();
    }
    state_->forget_moves();
}
const Settings& Scene::settings() const noexcept {
    return state_->narrow.settings();
}
const Shape& Scene::shape(BodyId body) const {
    return *state_->existing(body, "Scene::shape").shape;
}

void Scene::set_user_data(BodyId body, std::uint64_t data) {
    state_->existing(body, "Scene::set_user_data");
    state_->user_data[body.slot] = data;
}
std::uint64_t Scene::user_data(BodyId body) const {
    state_->existing(body, "Scene::user_data");
    return state_->user_data[body.slot];
}
void Scene::set_filter(BodyId body, std::uint32_t groups, std::uint32_t mask) {
    state_->existing(body, "Scene::set_filter");
    state_->set_filter(body.slot, {groups, mask, state_->finder.filter(body.slot).is_static});
}
void Scene::set_static(BodyId body, bool is_static) {
    state_->existing(body, "Scene::set_static");
    const BroadPhaseInput::Filter& filter = state_->finder.filter(body.slot);
    state_->set_filter(body.slot, {filter.groups, filter.mask, is_static});
}
bool Scene::is_static(BodyId body) const {
    state_->existing(body, "Scene::is_static");
    return state_->finder.filter(body.slot).is_static;
}
void Scene::set_sensor(BodyId body, bool is_sensor) {
    PlacedBody& own = state_->existing(body, "Scene::set_sensor");
    if (own.is_sensor == is_sensor) return;
    state_->set_sensor(own, is_sensor);
    state_->mark(body.slot);
}
bool Scene::is_sensor(BodyId body) const {
    return state_->existing(body, "Scene::is_sensor").is_sensor;
}
void Scene::set_pair_filter(std::function<bool(BodyId, BodyId)> filter) {
    State& s = *state_;
    OpenPairs::Admits admits;
    if (filter)
        admits = [&slots = s.slots, filter = std::move(filter)](const SlotPair& pair) {
            return filter(slots.id_in(pair.first), slots.id_in(pair.second));
        };
    s.pairs.set_gate(std::move(admits));
    s.finder.drop_list();
}

bool Scene::has(BodyId body) const noexcept {
    return state_->slots.is_there(body);
}

std::uint32_t Scene::body_count() const noexcept {
    return state_->slots.count();
}

void Scene::clear() {
    for (const BodyId body : bodies()) remove(body);
}

std::vector<BodyId> Scene::bodies() const {
    std::vector<BodyId> ids;
    for (BodySlot slot = 0; slot < state_->slots.end(); ++slot)
        if (state_->slots.is_taken(slot)) ids.push_back(state_->slots.id_in(slot));
    return ids;
}

void Scene::prepare() {
    state_->prepare_shapes();
    state_->pack_shapes();
    state_->narrow.parts().accelerate_shapes();
}

void Scene::forget_contacts() {
    state_->narrow.prepare();
    state_->narrow.forget_contacts();
    state_->touches.restore({}, {});
    state_->stepped = 0;
}

std::span<const Contact> Scene::find_contacts() {
    const FloatEnvironment environment;
    const auto start = std::chrono::steady_clock::now();
    state_->all_or_nothing([&] {
        state_->given_stand = false;
        state_->finder.find(state_->narrow, state_->bodies, state_->next, state_->pairs);
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    });
    return contacts();
}

std::span<const Contact> Scene::find_contacts(std::span<const Pair> pairs) {
    const FloatEnvironment environment;
    const bool others = state_->read_pairs(pairs);
    state_->all_or_nothing([&] {
        if (others) state_->set_pairs();
        return 0.0;
    });
    return contacts();
}

std::span<const Contact> Scene::contacts() const noexcept {
    return state_->narrow.contacts().all();
}
std::shared_ptr<const std::vector<Contact>> Scene::shared_contacts() const noexcept {
    return state_->narrow.contacts().shared();
}
std::span<const Contact> Scene::contacts(BodyId a, BodyId b) const {
    state_->existing(a, "Scene::contacts");
    state_->existing(b, "Scene::contacts");
    return state_->narrow.contacts().of(std::minmax({a.slot, b.slot}));
}
std::size_t Scene::write_contacts(std::span<const ContactOutput> columns) {
    state_->columns.run(state_->narrow.parts().executor(), contacts(), columns);
    return contacts().size();
}
std::span<const LostContact> Scene::lost_contacts() const noexcept {
    return state_->narrow.contacts().lost();
}
std::vector<std::shared_ptr<const Shape>> Scene::shapes() const {
    return state_->list_shapes();
}
std::vector<std::byte> Scene::save_state() const {
    const auto shapes = state_->list_shapes();
    return state_->save(shapes).encode(settings(), shapes);
}
void Scene::load_state(std::span<const std::byte> state, std::span<const std::shared_ptr<const Shape>> shapes) {
    State& s = *state_;
    const SavedScene saved = SavedScene::decode(state, settings(), shapes);
    clear();
    s.drop_pairs();
    s.narrow.prepare();
    s.narrow.forget_contacts();
    s.touches.restore({}, {});
    s.stats = {};
    try {
        s.load(saved, shapes);
    } catch (...) {
        s.drop_loaded();
        throw;
    }
}
std::span<const Touch> Scene::begun() const noexcept {
    return state_->touches.begun();
}
std::span<const Touch> Scene::ended() const noexcept {
    return state_->touches.ended();
}
std::span<const Touch> Scene::touching() const noexcept {
    return state_->touches.all();
}
const StepStats& Scene::stats() const noexcept {
    return state_->stats;
}
std::span<const Pair> Scene::pairs() const {
    return state_->name_pairs();
}
std::uint32_t Scene::device_of_pair(std::size_t i) const {
    const std::size_t count = state_->name_pairs().size();
    if (i >= count)
        throw InputError("Scene::device_of_pair: there is no pair " + std::to_string(i) + "; there are "
                         + std::to_string(count));
    const std::uint32_t slot = state_->pairs.all(state_->narrow.parts().executor()).slots[i];
    return static_cast<std::uint32_t>(state_->narrow.assignment().part_of(slot));
}
std::string Scene::device_choice() const {
    return state_->narrow.device_choice();
}
void Scene::visit_near(const std::function<double(const Vec3& low, const Vec3& high)>& away,
                       const std::function<double()>& farthest, const std::function<void(BodyId)>& visit) const {
    State& s = *state_;
    const WorldBoxes& world = s.up_to_date_boxes();
    const double by = 2 * world.rounding();
    const Vec3 more{by, by, by};
    world.tree().visit([&](const Box& box) { return away(box.low - more, box.high + more); }, farthest,
                       [&](BodySlot slot) { visit(s.slots.id_in(slot)); });
}
std::optional<Distance> Scene::distance(BodyId a, BodyId b, double max) const {
    const PlacedBody& first = state_->existing(a, "Scene::distance");
    const PlacedBody& second = state_->existing(b, "Scene::distance");
    return raycontact::distance(*first.shape, first.pose, *second.shape, second.pose, max);
}
std::vector<Prediction> Scene::predictions() const {
    return find_predictions(state_->narrow.kept_rays(state_->bodies), state_->bodies,
                            {{contacts(), state_->narrow.left_out()}});
}

} // namespace raycontact
