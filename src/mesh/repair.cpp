// SPDX-License-Identifier: Apache-2.0
#include "mesh/repair.h"

#include "mesh/nesting.h"
#include "mesh/patches.h"
#include "mesh/predicates.h"
#include "mesh/weld.h"

#include <string>
#include <utility>
#include <vector>

namespace raycontact {
namespace {

std::string counted(std::uint64_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/// Keeps the triangles for which keep(i) holds; tells how many went.
template <class Keep>
std::uint64_t keep_triangles(PreparedMesh& prepared, Keep&& keep) {
    std::size_t kept = 0;
    const std::size_t before = prepared.triangles.size();
    for (std::size_t i = 0; i < before; ++i) {
        if (!keep(i)) continue;
        prepared.triangles[kept] = prepared.triangles[i];
        prepared.triangle_index[kept++] = prepared.triangle_index[i];
    }
    prepared.triangles.resize(kept);
    prepared.triangle_index.resize(kept);
    return before - kept;
}

} // namespace

bool is_degenerate(const Triangle& triangle, std::span<const Vec3> vertices) {
    const auto [a, b, c] = triangle;
    return a == b || b == c || c == a || collinear(vertices[a], vertices[b], vertices[c]);
}

void drop_degenerate(PreparedMesh& prepared, std::span<const Vec3> vertices) {
    const std::uint64_t dropped =
        keep_triangles(prepared, [&](std::size_t i) { return !is_degenerate(prepared.triangles[i], vertices); });
    if (dropped > 0) prepared.report.repairs.push_back("dropped " + counted(dropped, "degenerate triangle"));
}

void drop_duplicates(PreparedMesh& prepared) {
    const std::vector<std::uint32_t> lowest = lowest_same_triangle(prepared.triangles);
    const std::uint64_t dropped = keep_triangles(prepared, [&](std::size_t i) { return lowest[i] == i; });
    if (dropped > 0) prepared.report.repairs.push_back("dropped " + counted(dropped, "duplicate triangle"));
}

void mend_windings(PreparedMesh& prepared, const TriangleBvh& bvh) {
    std::vector<Triangle>& triangles = prepared.triangles;
    const Patches patches = find_patches(triangles, sorted_half_edges(triangles));
    std::vector<char> turn(triangles.size(), 0);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Patch& patch = patches.list[patches.of[i]];
        const bool fewer_against = 2 * std::uint64_t{patch.turned} <= patch.size;
        if (patch.orientable) turn[i] = (patches.against[i] != 0) == fewer_against ? 1 : 0;
        if (turn[i]) std::swap(triangles[i][1], triangles[i][2]);
    }

    const std::vector<char> contradicts = patches_to_turn(prepared.vertices, triangles, patches, bvh);
    std::uint64_t mended = 0, turned_whole = 0, whole = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const std::uint32_t p = patches.of[i];
        if (contradicts[p]) {
            turn[i] = !turn[i];
            std::swap(triangles[i][1], triangles[i][2]);
        }
        if (patches.list[p].turned > 0) mended += turn[i] ? 1 : 0;
    }
    for (std::size_t p = 0; p < patches.list.size(); ++p) {
        ++whole;
        if (contradicts[p] && patches.list[p].turned == 0) ++turned_whole;
    }
    if (mended > 0)
        prepared.report.repairs.push_back("turned " + counted(mended, "triangle") + " to make windings agree");
    if (turned_whole > 0) {
        prepared.report.repairs.push_back("turned " + counted(turned_whole, "component") + " of "
                                          + std::to_string(whole) + " whose winding contradicts its nesting");
    }
}

} // namespace raycontact
