// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/shape.h>

#include <optional>

namespace raycontact::exact {

/// The volume that two closed meshes share, m^3, by CGAL in rational numbers, of their files' vertices as
/// placed in double. Nothing where CGAL says that it cannot.
std::optional<double> shared_volume(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b);

} // namespace raycontact::exact
