// SPDX-License-Identifier: Apache-2.0
#include <view/levels.h>

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact::view {

namespace {

std::vector<std::uint32_t> reduced(const std::vector<std::uint32_t>& triangles, const std::vector<float>& positions,
                                   std::size_t target) {
    constexpr float any_error = 1.0f; // relative to the extent: the count decides, not the error
    const std::size_t vertices = positions.size() / 3, stride = 3 * sizeof(float);
    std::vector<std::uint32_t> result(triangles.size());
    result.resize(meshopt_simplify(result.data(), triangles.data(), triangles.size(), positions.data(), vertices,
                                   stride, 3 * target, any_error, 0, nullptr));
    if (result.size() <= 6 * target) return result;
    // Borders and edges of several triangles stop it early; the other reduction does not keep them.
    std::vector<std::uint32_t> rough(triangles.size());
    rough.resize(meshopt_simplifySloppy(rough.data(), triangles.data(), triangles.size(), positions.data(), vertices,
                                        stride, 3 * target, any_error, nullptr));
    return rough.empty() ? result : rough;
}

} // namespace

Levels make_levels(std::span<const Vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles,
                   std::uint32_t most) {
    std::vector<float> positions;
    for (const Vec3& v : vertices)
        positions.insert(positions.end(), {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)});
    std::vector<std::uint32_t> level;
    for (const auto& t : triangles) level.insert(level.end(), t.begin(), t.end());
    if (level.size() > 3 * std::size_t{most}) level = reduced(level, positions, most);

    Levels levels;
    levels.triangles.push_back(level);
    while (level.size() / 3 > 2 * coarsest) {
        const std::size_t target = std::max<std::size_t>(level.size() / 3 / 4, coarsest);
        std::vector<std::uint32_t> next = reduced(level, positions, target);
        if (next.empty() || 4 * next.size() > 3 * level.size()) break; // it cannot be had much coarser
        levels.triangles.push_back(next);
        level = std::move(next);
    }

    // Only vertices in use, in the order in which the finest level names them.
    std::vector<std::uint32_t> place(positions.size() / 3, UINT32_MAX), used;
    for (auto& one : levels.triangles)
        for (std::uint32_t& v : one) {
            if (place[v] == UINT32_MAX) {
                place[v] = static_cast<std::uint32_t>(used.size());
                used.push_back(v);
            }
            v = place[v];
        }
    levels.low.fill(std::numeric_limits<float>::infinity());
    levels.high.fill(-std::numeric_limits<float>::infinity());
    for (const std::uint32_t v : used)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            levels.low[axis] = std::min(levels.low[axis], positions[3 * v + axis]);
            levels.high[axis] = std::max(levels.high[axis], positions[3 * v + axis]);
        }
    for (const std::uint32_t v : used) {
        std::array<std::uint16_t, 3> vertex{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const float extent = levels.high[axis] - levels.low[axis];
            const float part = extent > 0 ? (positions[3 * v + axis] - levels.low[axis]) / extent : 0;
            vertex[axis] = static_cast<std::uint16_t>(std::lround(65535 * std::clamp(part, 0.0f, 1.0f)));
        }
        levels.vertices.push_back(vertex);
    }
    return levels;
}

} // namespace raycontact::view
