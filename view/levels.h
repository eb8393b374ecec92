// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/shape.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact::view {

/// A mesh as the page draws it, in body frame: one list of vertices, and triangles for each level of detail.
struct Levels {
    std::array<float, 3> low{}, high{}; ///< metres, the box that 16 bits an axis are spread over
    std::vector<std::array<std::uint16_t, 3>> vertices;
    std::vector<std::vector<std::uint32_t>> triangles; ///< by level, finest first: three vertices each
};

/// About this many triangles in the coarsest level.
constexpr std::uint32_t coarsest = 100;
/// The finest level is the mesh itself, or what meshoptimizer makes of it where it has more triangles than `most`.
/// Each further level has a quarter of the triangles of the one before.
Levels make_levels(std::span<const Vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles,
                   std::uint32_t most);
inline Levels make_levels(const Shape& shape, std::uint32_t most) {
    return make_levels(shape.vertices(), shape.triangles(), most);
}

} // namespace raycontact::view
