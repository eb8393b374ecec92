// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contacts/changes.h"
#include "contacts/gather.h"
#include "contacts/place.h"
#include "rays/certified.h"
#include "rays/coherent.h"
#include "rays/ray_queue.h"

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
    void step(std::span<const PlacedBody> bodies, std::span<const Pair> pairs, std::vector<Contact>& contacts,
              StepStats& stats);
    std::span<const LostContact> lost_contacts() const { return changes_.lost(); }

private:
    void standard(std::span<const PlacedBody> bodies, std::span<const Pair> pairs, StepStats& stats);
    void certified(std::span<const PlacedBody> bodies, std::span<const Pair> pairs, StepStats& stats);
    void coherent(std::span<const PlacedBody> bodies, std::span<const Pair> pairs, StepStats& stats);
    void cast_certified(std::span<const PlacedBody> bodies, std::span<const Pair> pairs,
                        std::optional<double> threshold, std::vector<kernels::LocalContact>& contacts,
                        StepStats& stats);
    /// `standard` for ordered_.
    void cast_whole(std::vector<kernels::LocalContact>& contacts, StepStats& stats);
    /// The same contacts, without looking at blocks that are clear of the other body.
    void cast_near(std::span<const PlacedBody> bodies, std::span<const Pair> pairs,
                   std::span<const std::uint32_t> which, std::vector<kernels::LocalContact>& contacts,
                   StepStats& stats);
    /// The rays of queue_. near: as cast_standard() has it.
    void cast_queue(bool near, std::vector<kernels::LocalContact>& contacts, StepStats& stats);
    static void rename(std::vector<kernels::LocalContact>& contacts, std::span<const std::uint32_t> ordered);
    void merge(std::vector<kernels::LocalContact>& contacts, std::size_t second);
    void add(std::vector<kernels::LocalContact>& contacts, std::span<const kernels::LocalContact> others);
    void forget();

    Settings settings_;
    OpenDevice opened_;
    ShapeStore shapes_;
    std::vector<kernels::OrderedPair> ordered_;
    std::vector<float> margins_; ///< of ordered_
    Array<kernels::OrderedPair> device_pairs_;
    Array<float> device_margins_;
    RayQueue queue_;
    Motion motion_;
    CertifiedRays certified_;
    CoherentRays coherent_;
    Array<kernels::Hit> hits_;
    Gather gather_;
    Placer placer_;
    std::vector<Pair> fast_pairs_; ///< of predictive, that are left to certified
    std::vector<kernels::LocalContact> local_, certified_contacts_, near_, merged_;
    Changes changes_;
};

} // namespace raycontact
