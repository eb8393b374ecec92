// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

namespace raycontact::scenes {

/// How far one of two boxes (sizes, poses of their middles) must move, along the direction that is best, to come apart,
/// metres; 0 if they are apart. By separating axes.
double box_overlap(const Vec3& size_a, const Pose& a, const Vec3& size_b, const Pose& b);

} // namespace raycontact::scenes
