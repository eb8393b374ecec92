// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/body_id.h>
#include <raycontact/contact.h>
#include <raycontact/contact_columns.h>
#include <raycontact/error.h>
#include <raycontact/export.h>
#include <raycontact/prediction.h>
#include <raycontact/query.h>
#include <raycontact/settings.h>
#include <raycontact/shape.h>
#include <raycontact/step_stats.h>
#include <raycontact/user_memory.h>

#include <cstddef>
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
    BodyId body{}; ///< whose mesh the ray meets
};
/// The point of all surfaces that is nearest, and whose it is; of equally near bodies that with the lowest slot.
struct BodyClosestPoint : ClosestPoint {
    BodyId body{}; ///< on whose surface it lies
};
/// When a moving mesh, which is the first of the two, meets a body, and where.
struct BodyImpact : Impact {
    BodyId body{}; ///< that is met
};

/// Two bodies that touch, or no longer do.
struct Touch {
    BodyId body_a;   ///< has the lower slot
    BodyId body_b;   ///< has the higher slot
    Vec3 point;      ///< world frame, metres: between the witness points of its deepest contact, when it last had one
    Vec3f normal;    ///< unit, world frame, from a to b: that contact's
    float depth = 0; ///< metres: that contact's
    bool sensor = false; ///< one of them is a sensor: it has no contacts
};

/// Bodies with shapes and poses. It finds every contact between them where they are; it moves nothing, so a step is one
/// call of find_contacts(), not of a step(). Not thread-safe; use one scene per thread. All functions that take the id
/// of a body throw InputError naming it where it is not in the scene; has() alone does not. Where the last device
/// fails, those that say so throw std::runtime_error; the scene stays usable, and the next step tries again.
class RAYCONTACT_API Scene {
public:
    /// Throws InputError for settings that make no sense or name a device this machine or this version cannot use, and
    /// std::runtime_error for one that does not open.
    explicit Scene(const Settings& settings = {});
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    /// Gives the lowest free slot; no id is ever given twice. After remove() the slot of a body that was in a step is
    /// free after the next step, any other slot at once. Throws InputError for no shape, for a pose that is not finite
    /// and rigid to 1e-4 (nearest_rigid_pose() mends those that drifted), and where 2^32 - 1 bodies are there; and
    /// std::runtime_error where the last device fails.
    BodyId add(std::shared_ptr<const Shape> shape, const Pose& pose = {});
    /// No other body gets its slot before the next step is done, and none its id.
    void remove(BodyId body);
    /// Throws InputError naming the body when the pose is not finite and rigid to 1e-4; the old pose then stays.
    void set_pose(BodyId body, const Pose& pose);
    /// The same in bulk: poses[i] of bodies[i]. Throws InputError if there are not as many poses as bodies, and as
    /// set_pose(), naming the place in the list; then no pose changes.
    void set_poses(std::span<const BodyId> bodies, std::span<const Pose> poses);
    /// The same from memory of a device or of the host, one pose after the other: matrices as they are, quaternions
    /// normalised. Throws InputError also where the memory holds fewer poses than there are bodies, and
    /// std::runtime_error where its device fails; then no pose changes.
    void set_poses(std::span<const BodyId> bodies, const UserMemory& poses, PoseForm form,
                   NumberType type = NumberType::float32);
    /// As it was set last.
    const Pose& pose(BodyId body) const;
    /// Where the body is expected after the next step, for the speculative contacts of that step. Without it, the body
    /// is expected to go on as it did since the last step. Nothing without Settings::speculative. Throws InputError as
    /// set_pose().
    void set_next_pose(BodyId body, const Pose& pose);
    /// Metres: the margin of its speculative contacts with any body, instead of Settings::speculative_margin; of two
    /// such bodies the larger counts. Empty: as the settings say. Keeps until the body is removed. Throws InputError
    /// unless it is from 0 to 1e12.
    void set_speculative_margin(BodyId body, std::optional<double> margin);
    /// The one it was added with.
    const Shape& shape(BodyId body) const;
    /// A number of your own for each body, such as the address of your object; 0 at first.
    void set_user_data(BodyId body, std::uint64_t data);
    /// The number that set_user_data() gave it.
    std::uint64_t user_data(BodyId body) const;
    /// find_contacts() pairs two bodies only if the groups of each have a bit in common with the mask of the other. At
    /// first a body is in group 1, and its mask has all bits. find_contacts(pairs) tests every pair that it is given.
    void set_filter(BodyId body, std::uint32_t groups, std::uint32_t mask);
    /// A static body makes no pair with another static one: for the level, and for bodies that sleep. What touched when
    /// both became static goes on touching as long as the two stay near each other. At first no body is static.
    /// find_contacts(pairs) tests every pair that it is given.
    void set_static(BodyId body, bool is_static);
    /// As set_static() has it.
    bool is_static(BodyId body) const;
    /// A sensor has no contacts: what touches it is told by begun(), ended() and touching() alone. It counts from the
    /// next step on.
    void set_sensor(BodyId body, bool is_sensor);
    /// As set_sensor() has it.
    bool is_sensor(BodyId body) const;
    /// Asked about each pair that would come into being, as its boxes begin to touch, on the thread of the step: false
    /// keeps the two apart until their boxes have parted, and true lets them be a pair until then. The first body has
    /// the lower slot; pairs come in order. It is asked about all anew once it was set, and after other filters or
    /// find_contacts(pairs) had a say. It must not change the scene; what it throws, the step throws. Empty: none.
    /// find_contacts(pairs) tests every pair that it is given.
    void set_pair_filter(std::function<bool(BodyId, BodyId)> filter);
    /// It was added here and not removed.
    bool has(BodyId body) const noexcept;
    /// How many bodies are in the scene.
    std::uint32_t body_count() const noexcept;
    /// Of all bodies, by slot.
    std::vector<BodyId> bodies() const;
    /// Changes method, caster, direction or thresholds between two steps; forgets what the last method kept. Throws
    /// InputError for settings that make no sense, and for another Execution than the scene was made with.
    void set_settings(const Settings& settings);
    /// As they were given, or changed by set_settings().
    const Settings& settings() const noexcept;

    /// Shape::prepare() for the shapes of all bodies, so that the next step is as fast as later ones and counts repeat.
    /// Methods `iterative` and `predictive` do so before their steps: their contacts depend on it. Throws
    /// std::runtime_error where the last device fails.
    void prepare();

    /// Finds the pairs whose boxes overlap (our own broad phase) and then their contacts. Throws std::runtime_error
    /// where the last device fails, and InputError for a step too large for 32 bits (2^31 pairs, 2^32 rays). It then
    /// has no contacts, and the next step begins anew. A step in which nothing is new, gone or elsewhere has the
    /// contacts of the last one, no longer new. Nothing is sought then but by `iterative` and `predictive`.
    std::span<const Contact> find_contacts();
    /// Contacts of the pairs that the caller's own broad phase found: in any order, duplicates allowed. Throws as the
    /// other one; and InputError for a pair of a body with itself or one that is not in the scene, before it begins.
    std::span<const Contact> find_contacts(std::span<const Pair> pairs);

    /// As if the last step had found nothing: the contacts of the next are all new, and which of them stay (Settings::
    /// max_contacts_per_pair) depends on that step alone. What methods keep for pairs stays, and so do answers.
    void forget_contacts();

    /// Of the last step; sorted by the slots of both bodies, then by key(). Valid until the next step.
    std::span<const Contact> contacts() const noexcept;
    /// The same list for as long as it is held, by any thread: later steps write into another one.
    std::shared_ptr<const std::vector<Contact>> shared_contacts() const noexcept;
    /// Writes columns of them to memory of a device or of the host; returns their number, when all are there. Throws
    /// InputError, before it writes any, naming the column that has too little room, and std::runtime_error where the
    /// memory's device fails.
    std::size_t write_contacts(std::span<const ContactOutput> columns);
    /// Those of one pair, in either order of its bodies; none for two that were not paired.
    std::span<const Contact> contacts(BodyId a, BodyId b) const;
    /// What touched in the last step and does not in this one, in the same order; `Contact::is_new` marks the new ones.
    std::span<const LostContact> lost_contacts() const noexcept;
    /// Pairs that began to touch in the last step, those of sensors, too; by slots. Two bodies begin to touch with a
    /// contact that touches, or, but for sensors, a speculative one that will where both are expected next
    /// (set_next_pose()). They end without a contact when the points that touched last are apart along its normal by
    /// more than speculative_share of the smaller body's diagonal, or a quarter of it beside: what trembles touches.
    std::span<const Touch> begun() const noexcept;
    /// Pairs that no longer touch, and those of which a body was removed since the last step; by slots.
    std::span<const Touch> ended() const noexcept;
    /// All pairs that touch; by slots.
    std::span<const Touch> touching() const noexcept;
    /// Removes all bodies, as remove() does: touches of theirs are told as ended by the next step. No id is given
    /// again.
    void clear();

    /// All that later steps depend on, but for meshes, settings and the pair filter: bodies with ids, poses, filters
    /// and numbers, contacts, touches, and what the method keeps of pairs. Call it between two steps. Throws
    /// std::runtime_error where a device fails.
    std::vector<std::byte> save_state() const;
    /// The shapes that save_state() names by their places: each once, by the lowest slot that has it.
    std::vector<std::shared_ptr<const Shape>> shapes() const;
    /// Puts back what save_state() told, in this scene or in another one with equal settings (devices and threads may
    /// differ): later steps find, bit for bit, what they found after it. Ids mean again what they meant. shapes: those
    /// of shapes() when it was saved, in their order. What was here is gone, and nothing is told of it. Throws
    /// InputError for damaged bytes, another version or settings, or shapes of other counts or boxes, before anything
    /// changes; and std::runtime_error where a device fails: then the scene has no bodies.
    void load_state(std::span<const std::byte> state, std::span<const std::shared_ptr<const Shape>> shapes);

    /// What the last step did.
    const StepStats& stats() const noexcept;
    /// The pairs of the last step, sorted by their slots; without those of bodies that have been removed since. Makes
    /// the list when it is asked for; valid until the next step, add or remove.
    std::span<const Pair> pairs() const;
    /// Which entry of StepDetails::work found the contacts of pairs()[i]. Of a pair with a round body, which the host
    /// answers, the first. Throws InputError for another i.
    std::uint32_t device_of_pair(std::size_t i) const;
    /// Which device has the pairs, and why, for a person: with devices "auto" as "cpu: 1.2 ms a step, cuda:0 3.41 ms,
    /// measured with 7650 pairs", milliseconds of the narrow phase's part on a device; else "cpu: as given".
    std::string device_choice() const;
    /// What the last step of method `predictive` expects to touch next; sorted as contacts; none of other methods. Read
    /// from the devices at each call: for debugging and drawing. Call it before bodies move, come or go. Throws
    /// std::runtime_error where a device fails.
    std::vector<Prediction> predictions() const;

    // Queries of the bodies where they are now, poses set since the last step included, by the functions of query.h,
    // with what those promise and throw. Each walks a tree of the bodies' boxes and then looks into meshes, mostly the
    // nearest first. They change no answer: several threads may ask a scene at once as long as none changes it. wanted:
    // the bodies that count; empty: all.

    /// Says whether a query counts a body.
    using Wanted = std::function<bool(BodyId)>;
    /// The body that a ray meets first, within `max` metres. Throws InputError as raycontact::raycast().
    std::optional<BodyRayHit> raycast(const Vec3& origin, const Vec3& direction, double max = any_distance,
                                      const Wanted& wanted = {}) const;
    /// Whether raycast() has a hit; ends at the first one found. Throws InputError as it does.
    bool raycast_any(const Vec3& origin, const Vec3& direction, double max = any_distance,
                     const Wanted& wanted = {}) const;
    /// Each body that a ray meets within `max` metres, with its first hit: by distance, then by slot. Throws InputError
    /// as raycontact::raycast().
    std::vector<BodyRayHit> raycast_all(const Vec3& origin, const Vec3& direction, double max = any_distance,
                                        const Wanted& wanted = {}) const;
    /// The closest point of all surfaces, within `max` metres. Throws InputError as raycontact::closest_point().
    std::optional<BodyClosestPoint> closest_point(const Vec3& point, double max = any_distance,
                                                  const Wanted& wanted = {}) const;
    /// The bodies whose meshes intersect another one, placed here; by slot. Throws InputError as
    /// raycontact::intersects().
    std::vector<BodyId> overlaps(const Shape& shape, const Pose& pose, const Wanted& wanted = {}) const;
    /// Whether overlaps() has any; ends at the first one found. Throws InputError as it does.
    bool overlaps_any(const Shape& shape, const Pose& pose, const Wanted& wanted = {}) const;
    /// The body that a moving mesh meets first, or comes nearer to than `distance` metres: a shape cast. Bodies stay
    /// where they are; of several met at one time the one with the lowest slot. screw_motion() and straight_motion()
    /// make motions of two poses. As raycontact::time_of_impact() with its own tolerance; throws InputError as that.
    std::optional<BodyImpact> sweep(const Shape& shape, const RigidMotion& motion, double distance = 0,
                                    const Wanted& wanted = {}) const;
    /// All bodies that sweep() could meet, each for itself: by time, then by slot.
    std::vector<BodyImpact> sweep_all(const Shape& shape, const RigidMotion& motion, double distance = 0,
                                      const Wanted& wanted = {}) const;
    /// Of two bodies. Throws InputError as raycontact::distance().
    std::optional<Distance> distance(BodyId a, BodyId b, double max = any_distance) const;

private:
    /// Calls visit(body) for those whose boxes are not farther than farthest(), which it may lessen. away(low, high):
    /// of a box, infinite for those that do not count.
    RAYCONTACT_HIDDEN void visit_near(const std::function<double(const Vec3& low, const Vec3& high)>& away,
                                      const std::function<double()>& farthest,
                                      const std::function<void(BodyId)>& visit) const;

    template <class Met>
    RAYCONTACT_HIDDEN void visit_overlaps(const Shape& other, const Pose& place, const Wanted& wanted, Met&& met) const;

    struct RAYCONTACT_HIDDEN State;
    std::unique_ptr<State> state_;
};

} // namespace raycontact
