// SPDX-License-Identifier: Apache-2.0
#include "mesh/weld.h"

#include <bit>
#include <cstddef>
#include <xxhash.h>

namespace raycontact {
namespace {

/// Open addressing; items are met in order, so the first of its kind is the lowest. No result depends on the hash.
template <class Hash, class Equal>
std::vector<std::uint32_t> lowest_equal(std::size_t count, Hash&& hash, Equal&& equal) {
    constexpr std::uint32_t empty = 0xffffffffu;
    const std::size_t slots = std::bit_ceil(2 * count + 1);
    std::vector<std::uint32_t> table(slots, empty), lowest(count);
    for (std::size_t i = 0; i < count; ++i) {
        std::size_t slot = hash(i) & (slots - 1);
        while (table[slot] != empty && !equal(table[slot], i)) slot = (slot + 1) & (slots - 1);
        if (table[slot] == empty) table[slot] = static_cast<std::uint32_t>(i);
        lowest[i] = table[slot];
    }
    return lowest;
}

} // namespace

std::vector<std::uint32_t> lowest_at_same_place(std::span<const Vec3> points) {
    const auto hash = [&](std::size_t i) { // + 0.0 turns -0 into 0
        const Vec3 p{points[i].x + 0.0, points[i].y + 0.0, points[i].z + 0.0};
        return XXH3_64bits(&p, sizeof p);
    };
    return lowest_equal(points.size(), hash, [&](std::size_t i, std::size_t k) { return points[i] == points[k]; });
}

std::vector<std::uint32_t> lowest_same_triangle(std::span<const Triangle> triangles) {
    const auto turned = [&](std::size_t i) { // so that the lowest vertex comes first
        const auto [a, b, c] = triangles[i];
        return a <= b && a <= c ? Triangle{a, b, c} : b <= a && b <= c ? Triangle{b, c, a} : Triangle{c, a, b};
    };
    const auto hash = [&](std::size_t i) {
        const Triangle t = turned(i);
        return XXH3_64bits(&t, sizeof t);
    };
    return lowest_equal(triangles.size(), hash, [&](std::size_t i, std::size_t k) { return turned(i) == turned(k); });
}

} // namespace raycontact
