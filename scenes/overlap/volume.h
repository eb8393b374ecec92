// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/shape.h>

namespace raycontact::scenes {

/// The volume that two closed, outward meshes share, m^3; exact but for rounding in double. No predicate decides
/// anything, so touching and flush faces are no special cases. Where a mesh winds around a point more than once, as
/// often counts the point. Far slower than contacts: for checks.
double overlap_volume(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b);

} // namespace raycontact::scenes
