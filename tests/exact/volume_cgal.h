// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/shape.h>

#include <optional>

namespace raycontact::exact {

/// The volume that two closed meshes share, m^3, by CGAL: it cuts each surface along the other's with exact predicates.
/// Nothing where CGAL says that it cannot.
std::optional<double> shared_volume(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b);

} // namespace raycontact::exact
