// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>
#include <raycontact/shape.h>

namespace raycontact {

// What queries are asked with. Each throws InputError, which calls it `what`.
void check_reach(double metres, const char* what);        ///< the greatest distance of a query
void check_place(const Vec3& point, const char* what);    ///< finite, and within 1e30 m, so that no square overflows
void check_placed(const Pose& pose, const char* what);    ///< rigid, and so near
void check_is_mesh(const Shape& shape, const char* what); ///< not round: where faces are asked about

/// Of a ray, unit to rounding. Throws InputError where it is zero or not finite.
Vec3 checked_direction(const Vec3& given);

} // namespace raycontact
