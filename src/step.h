// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contacts/changes.h"
#include "contacts/gather.h"
#include "contacts/local_contacts.h"
#include "contacts/place.h"
#include "contacts/still_contacts.h"
#include "rays/certified.h"
#include "rays/coherent.h"
#include "rays/standard.h"

#include <raycontact/scene.h>

namespace raycontact {

/// The narrow phase, one step at a time, on one device. Keeps every array between steps, so that a step allocates
/// nothing once it has seen the worst.
class NarrowPhase {
public:
    explicit NarrowPhase(const Settings& settings);

    Device& device() { return *opened_.device; }
    Executor& executor() { return *opened_.executor; }
    ShapeStore& shapes() { return shapes_; }
    const Settings& settings() const { return settings_; }
    /// Forgets what the method before kept.
    void set_settings(const Settings& settings);

    /// pairs: sorted, each once, indices into bodies. Fills contacts and stats except broad_ms.
    void step(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs, std::vector<Contact>& contacts,
              StepStats& stats);
    std::span<const LostContact> lost_contacts() const { return changes_.lost(); }

private:
    void standard(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs, StepStats& stats);
    void certified(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs, StepStats& stats);
    void coherent(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs, StepStats& stats);
    void cast_certified(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs,
                        std::optional<double> threshold);
    /// which: what numbers `pairs` have in the step; empty: their own.
    void take_certified(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs,
                        std::span<const std::uint32_t> which, StepStats& stats);
    /// The contacts among the rays that a method has cast.
    template <class Rays>
    void take(const Rays& rays, std::span<const std::uint32_t> which, StepStats& stats);
    void forget();

    Settings settings_;
    OpenDevice opened_;
    ShapeStore shapes_;
    Motion motion_;
    StandardRays standard_;
    CertifiedRays certified_;
    CoherentRays coherent_;
    Gather gather_;
    LocalContacts local_;                      ///< by all; kept until the next step has asked for them
    std::vector<kernels::LocalContact> still_; ///< of the last step, still true
    Placer placer_;
    std::vector<SlotPair> fast_pairs_; ///< of predictive, that are left to certified
    Changes changes_;
};

} // namespace raycontact
