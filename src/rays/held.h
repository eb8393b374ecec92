// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/scan.h"
#include "shape/shape_data.h"
#include "shape/shape_store.h"

#include <algorithm>

namespace raycontact {

/// The hits of a step's rays, most of them by the one triangle that each can meet (docs/certified.md), for the
/// BVH caster. Bit for bit those of cast_standard() for vertices in the bounds, none for others.
class HeldRays {
public:
    /// holders: by pair, each with the range that its rays had in the last call; rays ascend by pair and slot.
    void cast(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs,
              const Array<kernels::Ray>& rays, const Array<kernels::Holder>& holders, Array<kernels::Hit>& hits);

    /// Metres around a ray that are searched for what it could meet: within the length of a triangle the surface mostly
    /// faces one way, farther off there are only more triangles to be asked. size: of the pair's smaller body, metres.
    static double tube_radius(double size, const ShapeData& target) { return std::min(size / 128, target.grain); }

    /// Of rays cast elsewhere nothing is known in the next step.
    void forget(Device& device) { held_.resize(device, 0); }

    /// Of the last call: rays that had to be cast.
    std::uint64_t cast_in_full() const { return cast_in_full_; }
    std::uint64_t bytes() const { return held_.size() * sizeof(kernels::Held); }

private:
    Scan scan_;
    Array<kernels::Held> held_, before_;
    Array<kernels::uint> casts_;
    std::uint64_t cast_in_full_ = 0;
};

} // namespace raycontact
