// SPDX-License-Identifier: Apache-2.0
#include <raycontact/recorder.h>

#include <recording/replay.h>
#include <recording/writer.h>

#include <raycontact/error.h>

#include <algorithm>
#include <map>
#include <vector>

namespace raycontact {

namespace {

/// To get a body its id; a slot that was given so often before the recording began would fill it with bodies.
constexpr int most_tries = 100'000;

} // namespace

struct Recorder::State {
    State(const std::filesystem::path& file, const Scene& s, const RecorderOptions& o)
        : scene(s), settings(s.settings()),
          writer(file, {o.scene, o.seed, o.bodies.value_or(s.body_count()), o.dt, settings, o.mesh_source}),
          hash(settings.direction) {}

    std::uint32_t shape_number(const Shape& shape) {
        const auto [at, is_new] = shapes.try_emplace(shape.shared_from_this(), 0);
        if (is_new) at->second = writer.add_shape(shape);
        return at->second;
    }

    // Until it gets this very id: the scene has given other bodies the slots and generations in between, which came and
    // went before a step saw them.
    void add(BodyId body, std::vector<BodyId>& passing) {
        const std::uint32_t shape = shape_number(scene.shape(body));
        for (int tries = 0;; ++tries) {
            if (tries > most_tries)
                throw InputError("Recorder::record: the scene gave slot " + std::to_string(body.slot) + " to "
                                 + std::to_string(body.generation) + " bodies before; begin recording earlier");
            const BodyId given = writer.add_body(shape);
            if (given == body) return;
            if (given.slot == body.slot)
                writer.remove_body(given);
            else
                passing.push_back(given);
        }
    }

    void follow_bodies() {
        const std::vector<BodyId> now = scene.bodies();
        std::vector<BodyId> gone, come, passing;
        const auto by_slot = [](BodyId a, BodyId b) {
            return std::pair(a.slot, a.generation) < std::pair(b.slot, b.generation);
        };
        std::ranges::set_difference(bodies, now, std::back_inserter(gone), by_slot);
        std::ranges::set_difference(now, bodies, std::back_inserter(come), by_slot);
        for (const BodyId body : gone) writer.remove_body(body);
        for (const BodyId body : come) add(body, passing);
        for (const BodyId body : passing) writer.remove_body(body);
        bodies = now;
    }

    const Scene& scene;
    const Settings settings; ///< at the start
    recording::Writer writer;
    ContactHash hash;
    std::map<std::shared_ptr<const Shape>, std::uint32_t> shapes;
    std::vector<BodyId> bodies; ///< recorded as being there, by slot
};

Recorder::Recorder(const std::filesystem::path& file, const Scene& scene, const RecorderOptions& options) {
    const Method method = scene.settings().method;
    if ((method == Method::iterative || method == Method::predictive) && !scene.pairs().empty())
        throw InputError("Recorder: method " + std::string(to_string(method))
                         + " keeps rays from step to step, and a replay would not have those of the steps before; make "
                           "the Recorder before the scene's first step");
    state_ = std::make_unique<State>(file, scene, options);
}
Recorder::~Recorder() = default;
Recorder::Recorder(Recorder&&) noexcept = default;
Recorder& Recorder::operator=(Recorder&&) noexcept = default;

void Recorder::record() {
    State& s = *state_;
    if (!recording::find_alike(s.settings, s.scene.settings()))
        throw InputError("Recorder::record: method, direction, features or thresholds of the scene have changed; a "
                         "recording has one "
                         "set of them, so begin another");
    s.follow_bodies();
    for (const Contact& contact : s.scene.contacts())
        for (const BodyId body : {contact.body_a, contact.body_b})
            if (!s.scene.has(body))
                throw InputError("Recorder::record: body " + std::to_string(body.slot) + " (generation "
                                 + std::to_string(body.generation)
                                 + ") is not there; record a step before bodies of its contacts are removed");
    const std::uint32_t step = s.writer.steps();
    s.writer.step(s.scene); // first: a step that is refused is in neither
    s.hash.add(step, s.scene.contacts());
}

void Recorder::finish() {
    state_->writer.finish(state_->hash.hex());
}

std::uint32_t Recorder::steps() const {
    return state_->writer.steps();
}
std::uint64_t Recorder::bytes() const {
    return state_->writer.bytes();
}
double Recorder::seconds() const {
    return state_->writer.seconds();
}
double Recorder::finish_seconds() const {
    return state_->writer.finish_seconds();
}
std::string Recorder::hash() const {
    return state_->hash.hex();
}

} // namespace raycontact
