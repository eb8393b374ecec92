// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/body_id.h>
#include <raycontact/contact.h>
#include <raycontact/device.h>
#include <raycontact/error.h>
#include <raycontact/prediction.h>
#include <raycontact/query.h>
#include <raycontact/settings.h>
#include <raycontact/shape.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace raycontact {

/// An unordered pair of bodies; the first has the lower slot.
using Pair = std::pair<BodyId, BodyId>;

/// What a query of a scene found, and on which body; of equally near bodies the one with the lowest slot.
struct BodyRayHit : RayHit {
    BodyId body{};
};
struct BodyClosestPoint : ClosestPoint {
    BodyId body{};
};

/// What the last step did.
struct StepStats {
    std::uint64_t pairs = 0;    ///< unordered pairs in the narrow phase
    std::uint64_t vertices = 0; ///< vertices tested against bounds, after whole clusters were ruled out
    /// `standard`: rays of the rule, the vertices inside the other body's bounds. `certified`: the vertices that it
    /// cannot prove safe; for pairs too fast for it, the vertices in the bounds whose block it cannot prove safe.
    /// `iterative` and `predictive`: the vertices in the bounds (`predictive` widens them) that a full look tested, and
    /// the rays followed.
    std::uint64_t rays = 0;
    std::uint64_t rays_cast =
        0; ///< traced through the mesh, along the ray or ahead of it; the rest were followed or known already
    std::uint64_t side_tests =
        0; ///< directions cast to tell inside from outside where the closest hits lay within rounding
    std::uint64_t pairs_full = 0;        ///< ordered pairs looked at in full: those new, fast, or moved far
    std::uint64_t pairs_asleep = 0;      ///< ordered pairs without rays, of which no vertex was tested
    std::uint64_t pairs_as_standard = 0; ///< ordered pairs that `certified` left to `standard`, which costs less there
    std::uint64_t walks = 0;             ///< rays followed from last step's triangle (iterative, predictive)
    std::uint64_t walks_lost = 0;        ///< of these, how many ended nowhere
    std::uint64_t walk_casts = 0;        ///< of those, how many were cast in full instead
    std::uint64_t predictions = 0;       ///< vertices followed without contact (predictive)
    std::uint64_t pair_bytes = 0;        ///< memory kept for the open pairs
    std::uint64_t contacts = 0;          ///< that touch
    std::uint64_t contacts_new = 0;      ///< of these, those that did not touch in the last step
    std::uint64_t contacts_lost = 0;     ///< that touched in the last step, and do not in this one
    /// Beside them in Scene::contacts(): those that do not touch yet.
    std::uint64_t contacts_speculative = 0;
    /// Found, but left out by Settings::max_contacts_per_pair or max_contacts.
    std::uint64_t contacts_reduced = 0;
    std::uint64_t contacts_merged = 0; ///< of those, how many say what one that was chosen says
    double ray_length = 0;             ///< sum over the contacts that touch, metres (paper section 5.2)
    double depth_max = 0;              ///< of all contacts, those left out as well, metres
    double broad_ms = 0;               ///< our broad phase; 0 when pairs were given
    double narrow_ms = 0;              ///< everything after the broad phase
    std::uint64_t pairs_moved = 0;     ///< from one device to another
    std::uint64_t bytes_moved = 0;     ///< of what was kept for them
    std::uint64_t devices_lost = 0;    ///< that failed in this step; others cast their pairs in full
    std::vector<DeviceWork> work;      ///< one entry a device, those lost included
    std::vector<std::string> warnings; ///< in plain words, as of a device that failed; the contacts are complete
};

/// Bodies with shapes and poses; each step finds every contact between them. Not thread-safe; use one scene per thread.
class Scene {
public:
    /// Throws InputError when settings name a device this machine or this version cannot use.
    explicit Scene(const Settings& settings = {});
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    /// Gives the lowest free slot; no id is ever given twice. After remove() the slot of a body that was in a step is
    /// free after the next step, any other slot at once. Throws InputError for a pose that is not finite and rigid to
    /// 1e-4, as every function here that takes one; nearest_rigid_pose() mends those that drifted.
    BodyId add(std::shared_ptr<const Shape> shape, const Pose& pose = {});
    /// From now on every function that takes this id throws InputError naming it, as for any body that is not in the
    /// scene. No other body gets its slot before the next step is done.
    void remove(BodyId body);
    /// Throws InputError naming the body when the pose is not finite and rigid; the old pose then stays.
    void set_pose(BodyId body, const Pose& pose);
    const Pose& pose(BodyId body) const;
    /// Where the body is expected after the next step, for the speculative contacts of that step. Without it, the body
    /// is expected to go on as it did since the last step. Nothing without Settings::speculative. Throws InputError as
    /// set_pose().
    void set_next_pose(BodyId body, const Pose& pose);
    /// Metres: the margin of its speculative contacts with any body, instead of Settings::speculative_margin; of two
    /// such bodies the larger counts. Empty: as the settings say. Keeps until the body is removed. Throws InputError
    /// unless it is finite and at least 0.
    void set_speculative_margin(BodyId body, std::optional<double> margin);
    const Shape& shape(BodyId body) const;
    /// A number of your own for each body, such as the address of your object; 0 at first.
    void set_user_data(BodyId body, std::uint64_t data);
    std::uint64_t user_data(BodyId body) const;
    /// step() pairs two bodies only if the groups of each have a bit in common with the mask of the other. At first a
    /// body is in group 1, and its mask has all bits. step(pairs) tests every pair that it is given.
    void set_filter(BodyId body, std::uint32_t groups, std::uint32_t mask);
    /// The body that a contact names by its slot. Throws InputError if the slot has none, as after remove().
    BodyId body_in(std::uint32_t slot) const;
    std::uint32_t body_count() const;
    /// Of all bodies, by slot.
    std::vector<BodyId> bodies() const;
    /// Changes method, caster, direction or thresholds between two steps; forgets what the last method kept. Throws
    /// InputError for settings that make no sense, and for other devices, another schedule or number of threads.
    void set_settings(const Settings& settings);
    const Settings& settings() const;

    /// Shape::prepare() for the shapes of all bodies, so that the next step is as fast as later ones and counts repeat.
    /// Methods `iterative` and `predictive` do so before their steps: their contacts depend on it.
    void prepare();

    /// Finds the pairs whose boxes overlap (our sweep and prune) and then their contacts.
    std::span<const Contact> step();
    /// Contacts of the pairs that the caller's own broad phase found: in any order, duplicates allowed. Throws
    /// InputError for a pair of a body with itself or a body that does not exist.
    std::span<const Contact> step(std::span<const Pair> pairs);

    /// Of the last step; sorted by (body_a, body_b, feature, vertex_body, vertex, triangle). Valid until the next step.
    std::span<const Contact> contacts() const;
    /// Those of one pair, in either order of its bodies; none for two that were not paired.
    std::span<const Contact> contacts(BodyId a, BodyId b) const;
    /// What touched in the last step and does not in this one, in the same order; `Contact::is_new` marks the new ones.
    std::span<const LostContact> lost_contacts() const;
    const StepStats& stats() const;
    /// The pairs of the last step, sorted by their slots.
    std::span<const Pair> pairs() const;
    /// Which entry of stats().work found the contacts of pairs()[i]. Throws InputError for another i.
    std::uint32_t device_of_pair(std::size_t i) const;
    /// What the last step of method `predictive` expects to touch next; sorted as contacts; none of other methods. Read
    /// from the devices at each call: for debugging and drawing. Call it before bodies move, come or go.
    std::vector<Prediction> predictions() const;

    // Queries of the bodies where they are now, poses set since the last step included, by the functions of query.h,
    // with what those promise and throw. Each looks at the boxes of all bodies and then into meshes, nearest first.
    // They change nothing: several threads may ask a scene at once as long as none changes it. wanted: the bodies that
    // count; empty: all.
    using Wanted = std::function<bool(BodyId)>;
    std::optional<BodyRayHit> raycast(const Vec3& origin, const Vec3& direction, double max = any_distance,
                                      const Wanted& wanted = {}) const;
    bool raycast_any(const Vec3& origin, const Vec3& direction, double max = any_distance,
                     const Wanted& wanted = {}) const;
    std::optional<BodyClosestPoint> closest_point(const Vec3& point, double max = any_distance,
                                                  const Wanted& wanted = {}) const;
    /// The bodies whose meshes intersect another one, placed here; by slot.
    std::vector<BodyId> overlaps(const Shape& shape, const Pose& pose, const Wanted& wanted = {}) const;
    /// Of two bodies. Throws InputError for one that is not in the scene.
    std::optional<Distance> distance(BodyId a, BodyId b, double max = any_distance) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace raycontact
