// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"

#include <span>

namespace raycontact {

/// An affine map: where the axes and the origin go.
struct Placement {
    Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, origin;

    /// Of a matrix of 4 x 4 by columns, whose last row is taken for 0 0 0 1.
    static Placement of_matrix(std::span<const double> m) {
        return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
    }
    Vec3 turned(const Vec3& v) const { return v.x * x + v.y * y + v.z * z; }
    Vec3 placed(const Vec3& p) const { return turned(p) + origin; }
    Placement after(const Placement& inner) const {
        return {turned(inner.x), turned(inner.y), turned(inner.z), placed(inner.origin)};
    }
    bool mirrors() const { return dot({x.x, y.x, z.x}, cross({x.y, y.y, z.y}, {x.z, y.z, z.z})) < 0; }
};

} // namespace raycontact
