// SPDX-License-Identifier: Apache-2.0
#include <recording/replay.h>

#include <algorithm>
#include <chrono>
#include <tuple>

namespace raycontact::recording {

namespace {

auto ray_of(const Contact& c) {
    return std::tuple(c.body_a, c.body_b, c.vertex_body, c.vertex);
}

} // namespace

void Follower::place(std::uint32_t i, std::span<const Pose> poses) {
    const std::vector<Body>& bodies = reader_.bodies();
    for (BodyId id = 0; id < bodies.size(); ++id) {
        const Body& body = bodies[id];
        if (body.first_step == i) scene_.add(reader_.shapes()[body.shape], poses[id]);
        // One that came and went between two steps was never in any, but has its id.
        if (body.end_step == i)
            scene_.remove(id);
        else if (body.alive(i))
            scene_.set_pose(id, poses[id]);
    }
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
            if (found[i].triangle != reference[j].triangle) ++other_triangle;
            ++i;
            ++j;
        }
    }
}

Replay replay(Reader& reader, const ReplayOptions& options) {
    Replay result;
    Follower follower(reader, options.settings);
    std::optional<Follower> reference;
    if (options.compare) {
        Settings standard = options.settings;
        standard.method = Method::standard;
        standard.skip_outside = false; // the reference casts every ray
        reference.emplace(reader, standard);
        result.wrong_rays.emplace();
    }
    ContactHash hash;
    std::vector<Pose> poses;
    std::vector<Pair> pairs;
    result.steps.reserve(reader.steps());
    for (std::uint32_t i = 0; i < reader.steps(); ++i) {
        reader.read_step(i, poses, pairs);
        const auto start = std::chrono::steady_clock::now();
        follower.place(i, poses);
        const std::span<const Contact> contacts = follower.scene().step(pairs);
        const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;

        const StepStats& stats = follower.scene().stats();
        hash.add(i, contacts);
        result.pairs_max = std::max(result.pairs_max, stats.pairs);
        result.rays += stats.rays;
        result.contacts += stats.contacts;
        result.ray_length += stats.ray_length;
        result.penetration_max = std::max(result.penetration_max, stats.depth_max);
        result.steps.push_back({time.count(), stats.narrow_ms});
        if (reference) {
            reference->place(i, poses);
            result.wrong_rays->add(contacts, reference->scene().step(pairs));
            result.wrong_rays->rays_compared += reference->scene().stats().rays;
        }
        if (options.progress) options.progress(i + 1);
    }
    result.hash = hash.hex();
    return result;
}

} // namespace raycontact::recording
