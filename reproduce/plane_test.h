// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/settings.h>
#include <raycontact/shape.h>

#include <cstdint>
#include <memory>

namespace raycontact::reproduce {

/// The paper's Figure 13: an object pressed into a plane, in many orientations and depths.
struct PlaneTest {
    std::shared_ptr<const Shape> shape;
    std::uint32_t orientations = 400, depths = 20;
    double depth_part = 0.1; ///< the deepest, as a part of the object's largest extent; the others lie evenly below
};

struct Deviation {
    double percent = 0;      ///< mean over all cases with contacts of 100 x |tangential force| / |normal force|
    std::uint64_t cases = 0; ///< with contacts
};

/// The ground is a closed slab far wider than the object; contacts come from a Scene with that direction, their forces
/// from springs. Orientations are random, the same in every call.
Deviation plane_deviation(const PlaneTest& test, Direction direction);

} // namespace raycontact::reproduce
