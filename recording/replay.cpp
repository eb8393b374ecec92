// SPDX-License-Identifier: Apache-2.0
#include <recording/replay.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <tuple>

namespace raycontact::recording {

namespace {

auto ray_of(const Contact& c) {
    return std::tuple(c.body_a, c.body_b, c.key());
}

bool is_reduced(const Settings& settings) {
    return settings.max_contacts_per_pair != 0 || settings.max_contacts != 0;
}

} // namespace

Follower::Follower(const Reader& reader, const Settings& settings) : reader_(reader), scene_(settings) {
    for (const auto& shape : reader.shapes()) shape->prepare(settings.execution.threads);
}

void Follower::place(std::uint32_t i, std::span<const Pose> poses) {
    const std::vector<BodyEvent>& events = reader_.events();
    for (; next_event_ < events.size() && events[next_event_].step <= i; ++next_event_)
        happen(events[next_event_], poses);
    for (const BodyId body : scene_.bodies()) scene_.set_pose(body, poses[body.slot]);
}

void Follower::happen(const BodyEvent& event, std::span<const Pose> poses) {
    const Body& body = reader_.bodies()[event.body];
    if (event.kind == BodyEvent::comes) {
        // One that came and went between two steps has no pose, but it had its slot.
        const Pose pose = body.alive(event.step) ? poses[body.id.slot] : Pose{};
        if (scene_.add(reader_.shapes()[body.shape], pose) != body.id)
            throw std::logic_error("a replay gave a body another slot than the recording; report this");
    } else if (reader_.version() > 1) {
        scene_.remove(body.id);
    } // in version 1 its slot was not given again: it stays, without pairs
}

void WrongRays::add(std::span<const Contact> found, std::span<const Contact> reference) {
    contacts_compared += reference.size();
    std::size_t i = 0, j = 0;
    while (i < found.size() || j < reference.size()) {
        if (j == reference.size() || (i < found.size() && ray_of(found[i]) < ray_of(reference[j]))) {
            ++invented;
            ++i;
        } else if (i == found.size() || ray_of(reference[j]) < ray_of(found[i])) {
            ++missed;
            ++j;
        } else {
            if (found[i].feature != reference[j].feature) ++other_triangle;
            ++i;
            ++j;
        }
    }
}

void WrongRays::add(const WrongRays& more) {
    missed += more.missed;
    invented += more.invented;
    other_triangle += more.other_triangle;
    rays_compared += more.rays_compared;
    contacts_compared += more.contacts_compared;
}

double WrongRays::percent() const {
    return rays_compared > 0 ? 100 * static_cast<double>(total()) / static_cast<double>(rays_compared)
                             : std::numeric_limits<double>::quiet_NaN();
}

bool find_alike(const Settings& recorded, const Settings& used) {
    const auto exact = [](Method method) { return method == Method::standard || method == Method::certified; };
    if (used.direction != recorded.direction || used.features != recorded.features
        || used.max_contacts_per_pair != recorded.max_contacts_per_pair || used.max_contacts != recorded.max_contacts)
        return false;
    // What stays of all contacts depends on the speculative ones.
    if (is_reduced(used)
        && (used.is_speculative() != recorded.is_speculative()
            || used.speculative_margin != recorded.speculative_margin))
        return false;
    if (exact(used.method) && exact(recorded.method)) return true;
    PaperOptions paper = used.paper;
    paper.caster = recorded.paper.caster; // no contact depends on it
    return used.method == recorded.method && paper == recorded.paper;
}

bool must_agree(const Settings& recorded, const Settings& used) {
    return find_alike(recorded, used) && !(is_reduced(used) && used.is_speculative());
}

Replay replay(Reader& reader, const ReplayOptions& options) {
    Replay result;
    Follower follower(reader, options.settings);
    std::optional<Follower> reference;
    if (options.compare) {
        if (options.settings.is_speculative())
            throw InputError("replay: rays cannot be compared of contacts that have none; set speculative to false");
        if (is_reduced(options.settings))
            throw InputError("replay: rays cannot be compared while some contacts are left out; set "
                             "max_contacts_per_pair and max_contacts to 0");
        Settings standard = options.settings;
        standard.method = Method::standard;
        standard.paper.skip_outside = false; // the reference casts every ray
        reference.emplace(reader, standard);
        result.wrong_rays.emplace();
    }
    ContactHash hash(options.settings.direction);
    std::vector<Pose> poses;
    std::vector<Pair> pairs;
    result.steps.reserve(reader.steps());
    for (std::uint32_t i = 0; i < reader.steps(); ++i) {
        reader.read_step(i, poses, pairs);
        const auto start = std::chrono::steady_clock::now();
        follower.place(i, poses);
        const std::span<const Contact> contacts = follower.scene().find_contacts(pairs);
        const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;

        const StepStats& stats = follower.scene().stats();
        hash.add(i, contacts);
        result.pairs_max = std::max(result.pairs_max, stats.pairs);
        result.rays += stats.details.rays;
        result.contacts += stats.contacts;
        result.ray_length += stats.details.ray_length;
        result.penetration_max = std::max(result.penetration_max, stats.depth_max);
        ReplayStep step;
        static_cast<StepStats&>(step) = stats;
        step.step_ms = time.count();
        if (reference) {
            reference->place(i, poses);
            step.wrong.add(contacts, reference->scene().find_contacts(pairs));
            step.wrong.rays_compared = reference->scene().stats().details.rays;
            result.wrong_rays->add(step.wrong);
        }
        result.steps.push_back(step);
        if (options.progress) options.progress(i + 1);
        if (options.stop && options.stop()) break;
    }
    result.hash = hash.hex();
    result.device_choice = follower.scene().device_choice();
    return result;
}

} // namespace raycontact::recording
