// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/ordered_pairs.h"
#include "rays/ray_queue.h"

#include <raycontact/scene.h>

namespace raycontact {

/// The rays of a step by the standard method (paper section 2.1): one from every vertex inside the other body's bounds,
/// unless a grid knows that it is outside, cast in full. Nothing is kept from step to step but room.
class StandardRays {
public:
    void fill(Device& device, Executor& executor, const ShapeStore& shapes, std::span<const PlacedBody> bodies,
              std::span<const SlotPair> pairs, const Settings& settings);
    /// Of some ordered pairs only, 2 x pair + direction, ascending. Blocks of vertices that are clear of the other body
    /// are left out; the contacts are the same.
    void fill_near(Device& device, Executor& executor, const ShapeStore& shapes, std::span<const PlacedBody> bodies,
                   std::span<const SlotPair> pairs, std::span<const std::uint32_t> which);

    const Array<kernels::OrderedPair>& pairs() const { return device_pairs_; }
    const Array<kernels::Ray>& rays() const { return queue_.rays(); }
    void cast(Device& device, Caster caster, const ShapeStore& shapes);
    const Array<kernels::Hit>& hits() const { return hits_; }
    /// 2 x pair + direction of each of pairs(), ascending.
    std::span<const std::uint32_t> ordered() const { return which_; }
    /// Adds what the last step did.
    void count(StepStats& stats) const;

private:
    std::vector<std::uint32_t> which_;
    std::vector<kernels::OrderedPair> host_pairs_;
    std::vector<float> margins_;
    Array<kernels::OrderedPair> device_pairs_;
    Array<float> device_margins_;
    RayQueue queue_;
    bool short_first_ = false; ///< as cast_standard() has it
    Array<kernels::Hit> hits_;
};

} // namespace raycontact
