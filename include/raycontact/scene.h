// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/body_id.h>
#include <raycontact/contact.h>
#include <raycontact/device.h>
#include <raycontact/settings.h>
#include <raycontact/shape.h>

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace raycontact {

/// An unordered pair of bodies; the first has the lower slot.
using Pair = std::pair<BodyId, BodyId>;

/// What the last step did.
struct StepStats {
    std::uint64_t pairs = 0;    ///< unordered pairs in the narrow phase
    std::uint64_t vertices = 0; ///< vertices tested against bounds, after whole clusters were ruled out
    /// Rays of the rule, vertices inside the other body's bounds. `certified` counts the vertices that it knows no
    /// reason to leave alone, of pairs too fast for it those in the bounds of blocks that it does not; `iterative` and
    /// `predictive` those among the vertices they looked at, `predictive` in bounds that it widened, and the rays they
    /// followed.
    std::uint64_t rays = 0;
    std::uint64_t rays_cast =
        0; ///< traced through the mesh, along the ray or ahead of it; of the rest it is known how they end
    std::uint64_t side_tests =
        0; ///< directions cast to tell inside from outside where the closest hits lay within rounding
    std::uint64_t pairs_full = 0;   ///< ordered pairs looked at in full: new, fast or far moved ones
    std::uint64_t pairs_asleep = 0; ///< ordered pairs of which nothing was asked: too far, or neither body moved
    std::uint64_t walks = 0;        ///< rays followed from last step's triangle (iterative, predictive)
    std::uint64_t walks_lost = 0;   ///< of these, how many ended nowhere
    std::uint64_t walk_casts = 0;   ///< of those, how many were cast in full instead
    std::uint64_t predictions = 0;  ///< vertices followed without contact (predictive)
    std::uint64_t pair_bytes = 0;   ///< memory of what is kept for the open pairs
    std::uint64_t contacts = 0;
    std::uint64_t contacts_new = 0;  ///< whose key the step before did not have
    std::uint64_t contacts_lost = 0; ///< of the step before, whose key this one does not have
    double ray_length = 0;           ///< sum of the contacts' ray lengths, metres (paper section 5.2)
    double depth_max = 0;            ///< metres
    double broad_ms = 0;             ///< our broad phase; 0 when pairs were given
    double narrow_ms = 0;            ///< everything after the broad phase
    std::vector<DeviceWork> work;    ///< one entry a device
};

/// Bodies with shapes and poses; each step finds every contact between them. Not thread-safe; use one scene per thread.
class Scene {
public:
    /// Throws InputError when settings name a device this machine or this version cannot use.
    explicit Scene(const Settings& settings = {});
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    /// Gives the lowest free slot; no id is ever given twice. The slot of a body that was in a step is free again after
    /// the next one, that of any other at once. Throws InputError for a pose that is not finite and rigid.
    BodyId add(std::shared_ptr<const Shape> shape, const Pose& pose = {});
    /// From here on the id is refused: like every function that takes one, throws InputError naming a body that is not
    /// in the scene. Until the next step is done no other body has its slot.
    void remove(BodyId body);
    /// Throws InputError naming the body when the pose is not finite and rigid; the old pose then stays.
    void set_pose(BodyId body, const Pose& pose);
    const Pose& pose(BodyId body) const;
    const Shape& shape(BodyId body) const;
    /// The body that a contact names. Throws InputError where that slot has none, as when it has been removed since.
    BodyId body_in(std::uint32_t slot) const;
    std::uint32_t body_count() const;
    /// Changes method, caster, direction or thresholds between two steps; nothing that another method kept is used.
    /// Throws InputError for settings that make no sense, or for another device or number of threads than before.
    void set_settings(const Settings& settings);
    const Settings& settings() const;

    /// Finds the pairs whose boxes overlap (our sweep and prune) and then their contacts.
    std::span<const Contact> step();
    /// Contacts of the pairs a caller's own broad phase found, any order, duplicates allowed. Throws InputError for a
    /// pair of a body with itself or a body that does not exist.
    std::span<const Contact> step(std::span<const Pair> pairs);

    /// Of the last step; sorted by (body_a, body_b, vertex_body, vertex). Valid until the next step.
    std::span<const Contact> contacts() const;
    /// Contacts of the step before that are gone, in the same order; `Contact::is_new` says which ones came.
    std::span<const LostContact> lost_contacts() const;
    const StepStats& stats() const;
    /// The pairs of the last step, sorted by their slots.
    std::span<const Pair> pairs() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace raycontact
