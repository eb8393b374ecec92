// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/measure.h"

#include <algorithm>
#include <cstdint>

namespace raycontact {

/// A place on the curve that fills a cube (Morton 1966): the bits of its coordinates by turns, 21 of each. Those that
/// follow each other on it are near each other. low, scale: of the cube, which is 2^21 - 1 wide once it is scaled.
inline std::uint64_t place_on_curve(const Vec3& p, const Vec3& low, double scale) {
    // Two zero bits before each of the lowest 21.
    const auto spread = [](double coordinate) {
        auto x = static_cast<std::uint64_t>(std::clamp(coordinate, 0.0, 2097151.0));
        x = (x | x << 32) & 0x001f00000000ffff;
        x = (x | x << 16) & 0x001f0000ff0000ff;
        x = (x | x << 8) & 0x100f00f00f00f00f;
        x = (x | x << 4) & 0x10c30c30c30c30c3;
        return (x | x << 2) & 0x1249249249249249;
    };
    const Vec3 at = scale * (p - low);
    return spread(at.x) << 2 | spread(at.y) << 1 | spread(at.z);
}

} // namespace raycontact
