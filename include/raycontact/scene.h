// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>
#include <raycontact/settings.h>
#include <raycontact/shape.h>

#include <cstdint>
#include <memory>
#include <span>
#include <utility>

namespace raycontact {

using BodyId = std::uint32_t;

/// An unordered pair of bodies, first < second.
using Pair = std::pair<BodyId, BodyId>;

/// What the last step did.
struct StepStats {
    std::uint64_t pairs = 0;     ///< unordered pairs in the narrow phase
    std::uint64_t vertices = 0;  ///< vertices tested against bounds, after whole clusters were ruled out
    std::uint64_t rays = 0;      ///< rays of the rule: vertices inside the other body's bounds
    std::uint64_t rays_cast = 0; ///< of these, cast; the vertices of the rest are known to be outside the other mesh
    std::uint64_t side_tests =
        0; ///< directions cast to tell inside from outside where the closest hits lay within rounding
    std::uint64_t contacts = 0;
    double ray_length = 0; ///< sum of the contacts' ray lengths, metres (paper section 5.2)
    double depth_max = 0;  ///< metres
    double broad_ms = 0;   ///< our broad phase; 0 when pairs were given
    double narrow_ms = 0;  ///< everything after the broad phase
};

/// Bodies with shapes and poses; each step finds every contact between them. Not thread-safe; use one scene per thread.
class Scene {
public:
    /// Throws InputError when settings name a device this machine or this version cannot use.
    explicit Scene(const Settings& settings = {});
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    /// Ids count up from 0 and are never given twice. Throws InputError for a pose that is not finite and rigid.
    BodyId add(std::shared_ptr<const Shape> shape, const Pose& pose = {});
    void remove(BodyId body);
    /// Throws InputError naming the body when the pose is not finite and rigid; the old pose then stays.
    void set_pose(BodyId body, const Pose& pose);
    const Pose& pose(BodyId body) const;
    const Shape& shape(BodyId body) const;
    std::uint32_t body_count() const;

    /// Finds the pairs whose boxes overlap (our sweep and prune) and then their contacts.
    std::span<const Contact> step();
    /// Contacts of the pairs a caller's own broad phase found, any order, duplicates allowed. Throws InputError for a
    /// pair of a body with itself or a body that does not exist.
    std::span<const Contact> step(std::span<const Pair> pairs);

    /// Of the last step; sorted by (body_a, body_b, vertex_body, vertex). Valid until the next step.
    std::span<const Contact> contacts() const;
    const StepStats& stats() const;
    /// The pairs of the last step, sorted.
    std::span<const Pair> pairs() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace raycontact
