// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/vector.h>

namespace raycontact {

/// Where two lines come closest, in parts of their directions: a + first x along, p + second x edge.
struct ClosestOnLines {
    double first, second;
};
/// square: |along x edge|^2, which is not 0: they are not parallel.
inline ClosestOnLines closest_on_lines(const Vec3& a, const Vec3& along, const Vec3& p, const Vec3& edge,
                                       double square) {
    const Vec3 between = a - p;
    const double mixed = dot(along, edge);
    return {(mixed * dot(edge, between) - length2(edge) * dot(along, between)) / square,
            (length2(along) * dot(edge, between) - mixed * dot(along, between)) / square};
}

} // namespace raycontact
