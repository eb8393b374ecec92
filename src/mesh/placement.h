// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"

#include <raycontact/pose.h>

#include <set>
#include <span>
#include <utility>

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

/// Makes rigid poses of the placements of an assembly's parts.
class PartScales {
public:
    /// A pose, and what is left to be done to the mesh first: a scale where the placement turns and scales alike in all
    /// directions, else all but its translation.
    std::pair<Pose, Placement> split(const Placement& placement);

private:
    /// Scales that differ by the rounding of float32 matrices alone are one: the first of them, to seven digits. The
    /// digits of those just below a power of ten are counted from it, as 0.99999998 means 1.
    double shared(double size);

    std::set<double> scales_;
};

} // namespace raycontact
