// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "broadphase/device_broad_phase.h"
#include "contacts/place.h"
#include "device/counting.h"
#include "edges/edge_stage.h"
#include "part/pipeline.h"

#include <memory>
#include <vector>

namespace raycontact {

/// What one device does for the pairs that are its own: all from poses to contacts in the world. It keeps the shapes
/// and a pipeline. It knows bodies by their slots, and no other part.
class Part {
public:
    explicit Part(OpenDevice opened);

    const DeviceInfo& device() const { return device_->info(); }
    Executor& executor() { return *executor_; }
    ShapeStore& shapes() { return shapes_; }

    /// Whether its device can find the pairs of a scene, and has not the host's memory, where the host would as soon.
    bool can_find_pairs() const {
        return can_find_in_double() && !device_->traits().shares_memory && !broad_phase_.gave_up();
    }
    bool can_find_in_double() const { return device_->traits().has_double; }
    /// As DeviceBroadPhase; before begin().
    std::size_t known_slots() const { return broad_phase_.slots(); }
    DeviceBroadPhase::Found find_pairs(const DeviceBroadPhase::Changes& changes, bool whole) {
        return broad_phase_.find(*device_, changes, whole);
    }

    /// How it answers a step with these settings.
    Answers answers(const Settings& settings) const { return raycontact::answers(settings, device_->traits()); }

    /// The pairs of a part: those that are open, and those of them that a step asks about (Update::pairs).
    struct Pairs {
        const PairSlots& open;
        std::span<const SlotPair> asked;
        std::span<const std::uint32_t> slots;
    };
    /// Starts a step. bodies: of the scene, by slot. All stays valid until the next begin(). A part that goes on
    /// without pairs asks nothing of its device.
    void begin(std::span<const PlacedBody> bodies, const SlotChanges& moved, const Pairs& pairs,
               const Settings& settings);
    /// The contacts of the pairs that were asked about, or if it answers for all, of all; sorted.
    void end(std::vector<Contact>& contacts);
    /// After end(), in the same step: sorts in the contacts of pairs that are new to this part, because another one
    /// failed. The part has them from now on, in these slots.
    void take_over(const PairList& pairs, std::vector<Contact>& contacts);

    /// The state kept for some pairs of the last step, for another part to go on with as this part would have. bodies
    /// as in the last step. Empty if the contacts do not depend on that state.
    /// Before import_state() of pairs that another scene had: how bodies are placed, as of a step.
    void learn(std::span<const PlacedBody> bodies, const SlotChanges& moved) {
        motion_.update(*executor_, bodies, moved);
    }
    std::vector<std::byte> export_state(std::span<const PlacedBody> bodies, const PairList& pairs);
    /// Adds such state: of the same pairs, in the slots that they have in this part. Call it before the begin() that
    /// first has them, with the same bodies.
    void import_state(std::span<const PlacedBody> bodies, const PairList& pairs, std::span<const std::byte> bytes);

    /// Adds the rays kept for the next step; bodies as in the last step.
    void list_kept_rays(std::span<const PlacedBody> bodies, std::vector<KeptRay>& rays);

    /// Adds what the last step did.
    void count(StepStats& stats) const;
    /// The device's work since the last call.
    DeviceWork take_work();

    /// After all of a step: frees what the next makes anew.
    void trim();
    /// Forgets what the methods kept.
    void forget();

private:
    Update update(std::span<const PlacedBody> bodies, const Pairs& pairs) const;
    Update update() const { return update(bodies_, {*open_, asked_, slots_}); }
    void place(const Update& now, const Pipeline& found, std::vector<Contact>& contacts);

    std::unique_ptr<Executor> executor_;
    std::unique_ptr<CountingDevice> device_;
    ShapeStore shapes_;
    DeviceBroadPhase broad_phase_;
    Motion motion_;
    Pipeline pipeline_;
    Placer placer_;
    EdgeStage edges_;
    /// Pairs adopted in the last step, in a pipeline of their own: the other one has done its step, and would follow
    /// its rays twice.
    struct Adopted {
        PairSlots open;
        PairList pairs;
        Pipeline pipeline;
        Pairs all() const { return {open, pairs.pairs, pairs.slots}; }
    };
    std::vector<std::unique_ptr<Adopted>> adopted_;

    bool had_none_ = false;              ///< no pairs in the last step
    bool idle_ = false;                  ///< no pairs in this one either
    std::span<const PlacedBody> bodies_; ///< of the step, as what follows
    const SlotChanges* moved_;
    const PairSlots* open_;
    std::span<const SlotPair> asked_;
    std::span<const std::uint32_t> slots_;
    const Settings* settings_;
};

} // namespace raycontact
