// SPDX-License-Identifier: Apache-2.0
#include "query/checks.h"

#include "mesh/vector.h"

#include <raycontact/error.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace raycontact {

namespace {

double largest_of(const Vec3& v) {
    return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

} // namespace

void check_reach(double metres, const char* what) {
    if (!(metres >= 0)) // also not a number
        throw InputError(std::string(what)
                         + ": the greatest distance is negative or not a number; give metres, or "
                           "infinity for any distance");
}

void check_place(const Vec3& point, const char* what) {
    if (!is_finite(point)) throw InputError(std::string(what) + ": a coordinate is not a finite number");
    if (largest_of(point) > 1e30)
        throw InputError(std::string(what) + ": farther than 1e30 m from the origin; give a nearer one");
}

void check_placed(const Pose& pose, const char* what) {
    check_pose(pose, what);
    check_place(pose.translation, what);
}

void check_is_mesh(const Shape& shape, const char* what) {
    if (shape.round() == nullptr) return;
    throw InputError(std::string(what)
                     + " is round, and this is about faces: give a mesh, or ask distance() or separation()");
}

Vec3 checked_direction(const Vec3& given) {
    if (!is_finite(given)) throw InputError("raycast: the direction has a coordinate that is not a finite number");
    const double largest = largest_of(given);
    if (largest == 0) throw InputError("raycast: the direction is zero; give one of any length above 0");
    // By a power of two first, so that no square overflows or underflows.
    int exponent = 0;
    std::frexp(largest, &exponent);
    return unit({std::ldexp(given.x, -exponent), std::ldexp(given.y, -exponent), std::ldexp(given.z, -exponent)});
}

} // namespace raycontact
