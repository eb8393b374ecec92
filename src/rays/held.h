// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/scan.h"
#include "shape/shape_store.h"

#include <span>

namespace raycontact {

/// The hits of a step's rays, most of them by the one triangle that each is known to meet (docs/certified.md), for the
/// BVH caster. Bit for bit those of cast_standard() for vertices in the bounds, none for others.
class HeldRays {
public:
    /// holders: by pair, each with the range that its rays had in the last call; rays ascend by pair and slot.
    void cast(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs,
              const Array<kernels::Ray>& rays, std::span<const kernels::Holder> holders, Array<kernels::Hit>& hits);

    /// Of rays cast elsewhere nothing is known in the next step.
    void forget(Device& device) { held_.resize(device, 0); }

    /// Of the last call: rays that had to be cast.
    std::uint64_t cast_in_full() const { return cast_in_full_; }
    std::uint64_t bytes() const { return held_.size() * sizeof(kernels::Held); }

private:
    Scan scan_;
    Array<kernels::Holder> holders_;
    Array<kernels::Held> held_, before_;
    Array<kernels::uint> casts_;
    std::uint64_t cast_in_full_ = 0;
};

} // namespace raycontact
