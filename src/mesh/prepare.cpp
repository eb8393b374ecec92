// SPDX-License-Identifier: Apache-2.0
#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include "executor/float_environment.h"
#include "mesh/check.h"
#include "mesh/input_file.h"
#include "mesh/nesting.h"
#include "mesh/predicates.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <xxhash.h>

namespace raycontact {
namespace {

/// The lowest index of an equal item, for each item, in linear time; -0 and 0 must have been made equal. Open
/// addressing; items are visited in order, so the first of its kind is the lowest. No result depends on the hash.
template <class Item>
std::vector<std::uint32_t> lowest_equal(const std::vector<Item>& items) {
    constexpr std::uint32_t empty = 0xffffffffu;
    const std::size_t slots = std::bit_ceil(2 * items.size() + 1);
    std::vector<std::uint32_t> table(slots, empty), lowest;
    lowest.reserve(items.size());
    for (std::uint32_t i = 0; i < items.size(); ++i) {
        std::size_t slot = XXH3_64bits(&items[i], sizeof(Item)) & (slots - 1);
        while (table[slot] != empty && items[table[slot]] != items[i]) slot = (slot + 1) & (slots - 1);
        if (table[slot] == empty) table[slot] = i;
        lowest.push_back(table[slot]);
    }
    return lowest;
}

/// The triangles of the file over file vertices, the lowest of each place.
PreparedMesh weld(const Mesh& mesh) {
    std::vector<Vec3> places(mesh.vertices);
    for (Vec3& p : places) p = p + Vec3{}; // turns -0 into 0
    const std::vector<std::uint32_t> lowest = lowest_equal(places);
    PreparedMesh prepared;
    prepared.name = mesh.name;
    for (const auto& [a, b, c] : mesh.triangles) prepared.triangles.push_back({lowest[a], lowest[b], lowest[c]});
    prepared.triangle_index.resize(mesh.triangles.size());
    std::iota(prepared.triangle_index.begin(), prepared.triangle_index.end(), 0u);
    return prepared;
}

/// Whether a vertex occurs twice or all three lie on one line, exactly.
bool is_degenerate(const Triangle& triangle, std::span<const Vec3> vertices) {
    const auto [a, b, c] = triangle;
    return a == b || b == c || c == a || collinear(snapped(vertices[a]), snapped(vertices[b]), snapped(vertices[c]));
}

std::vector<Vec3> all_snapped(std::span<const Vec3> vertices) {
    std::vector<Vec3> exact;
    exact.reserve(vertices.size());
    for (const Vec3& v : vertices) exact.push_back(snapped(v));
    return exact;
}

std::vector<std::uint32_t> triangles_with_area(const PreparedMesh& mesh, std::span<const Vec3> exact) {
    std::vector<std::uint32_t> with_area;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
        if (!is_degenerate(mesh.triangles[i], exact)) with_area.push_back(i);
    return with_area;
}

std::string counted(std::size_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/// Drops the triangles for which drop(i) holds, and reports how many.
template <class Drop>
void drop_triangles(PreparedMesh& prepared, const char* kind, Drop&& drop) {
    std::size_t kept = 0;
    const std::size_t before = prepared.triangles.size();
    for (std::size_t i = 0; i < before; ++i) {
        if (drop(i)) continue;
        prepared.triangles[kept] = prepared.triangles[i];
        prepared.triangle_index[kept++] = prepared.triangle_index[i];
    }
    prepared.triangles.resize(kept);
    prepared.triangle_index.resize(kept);
    if (kept < before) prepared.report.repairs.push_back("dropped " + counted(before - kept, kind));
}

/// Drops degenerate triangles, and those with the vertices and the winding of an earlier one.
void drop_useless(PreparedMesh& prepared, std::span<const Vec3> vertices) {
    std::vector<Triangle>& triangles = prepared.triangles;
    drop_triangles(prepared, "degenerate triangle",
                   [&](std::size_t i) { return is_degenerate(triangles[i], vertices); });
    std::vector<Triangle> turned(triangles); // rotated so that the lowest vertex comes first
    for (Triangle& t : turned) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    const std::vector<std::uint32_t> lowest = lowest_equal(turned);
    drop_triangles(prepared, "duplicate triangle", [&](std::size_t i) { return lowest[i] != i; });
}

/// Replaces file vertices by the distinct ones in use.
void number_vertices(const Mesh& mesh, PreparedMesh& prepared) {
    std::vector<std::uint32_t> number(mesh.vertices.size(), 0);
    for (const Triangle& t : prepared.triangles) {
        for (const std::uint32_t v : t) number[v] = 1;
    }
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] == 0) continue;
        number[v] = static_cast<std::uint32_t>(prepared.vertices.size());
        prepared.vertices.push_back(mesh.vertices[v]);
        prepared.vertex_index.push_back(static_cast<std::uint32_t>(v));
    }
    for (Triangle& t : prepared.triangles) {
        for (std::uint32_t& v : t) v = number[v];
    }
}

/// Makes the windings of each orientable patch agree with the majority, then turns closed patches whose winding
/// contradicts their nesting.
void mend_windings(PreparedMesh& prepared, const Patches& patches, const TriangleBvh& bvh) {
    std::vector<Triangle>& triangles = prepared.triangles;
    const std::vector<Triangle> before(triangles);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Patch& patch = patches.list[patches.of[i]];
        const bool fewer_against = 2 * std::uint64_t{patch.turned} <= patch.size;
        if (patch.orientable && (patches.against[i] != 0) == fewer_against) std::swap(triangles[i][1], triangles[i][2]);
    }
    const std::vector<char> contradicts = patches_to_turn(prepared, patches, bvh);
    std::size_t mended = 0, turned_whole = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const std::uint32_t p = patches.of[i];
        if (contradicts[p]) std::swap(triangles[i][1], triangles[i][2]);
        if (patches.list[p].turned > 0 && triangles[i] != before[i]) ++mended;
    }
    for (std::size_t p = 0; p < patches.list.size(); ++p) {
        if (contradicts[p] && patches.list[p].turned == 0) ++turned_whole;
    }
    if (mended > 0)
        prepared.report.repairs.push_back("turned " + counted(mended, "triangle") + " to make windings agree");
    if (turned_whole > 0) {
        prepared.report.repairs.push_back("turned " + counted(turned_whole, "component") + " of "
                                          + std::to_string(patches.list.size())
                                          + " whose winding contradicts its nesting");
    }
}

/// Few triangles are done before other threads wake.
Executor executor_for(std::size_t triangles) {
    return Executor(triangles < 4096 ? 1 : 0);
}

} // namespace

PreparedMesh prepare_mesh(const Mesh& mesh, Repair repair) {
    const FloatEnvironment environment; // the predicates need rounding to nearest
    const std::string name = mesh.name.empty() ? "mesh" : printable(mesh.name);
    check_mesh(mesh, name);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        // Products of four coordinates must fit float32, with which rays are cast.
        const auto& [x, y, z] = mesh.vertices[i];
        if (std::max({std::fabs(x), std::fabs(y), std::fabs(z)}) > greatest_coordinate)
            throw InputError(name + ": vertex " + std::to_string(i)
                             + " is further than 1e9 m from the origin; scale the mesh");
    }
    PreparedMesh prepared = weld(mesh);
    if (repair == Repair::allowed) drop_useless(prepared, mesh.vertices);
    number_vertices(mesh, prepared);

    Executor executor = executor_for(prepared.triangles.size());
    const std::vector<Vec3> exact = all_snapped(prepared.vertices);
    std::vector<std::uint32_t> with_area = triangles_with_area(prepared, exact);
    if (with_area.empty()) throw InputError(name + ": no triangle has an area");
    check_size(prepared.vertices, name);
    const TriangleBvh bvh(exact, prepared.triangles, std::move(with_area), executor);
    std::vector<HalfEdge> edges = sorted_half_edges(prepared.triangles);
    const Patches patches = find_patches(prepared.triangles, edges);
    if (repair == Repair::allowed) {
        mend_windings(prepared, patches, bvh);
        edges = sorted_half_edges(prepared.triangles);
    }
    prepared.report.file_vertices = mesh.vertices.size();
    prepared.report.file_triangles = mesh.triangles.size();
    fill_report(prepared, patches, edges, exact, bvh, executor);
    return prepared;
}

MeshReport measured_report(const PreparedMesh& mesh) {
    const FloatEnvironment environment;
    Executor executor = executor_for(mesh.triangles.size());
    const std::vector<Vec3> exact = all_snapped(mesh.vertices);
    std::vector<std::uint32_t> with_area = triangles_with_area(mesh, exact);
    if (with_area.empty()) throw InputError("no triangle has an area");
    const TriangleBvh bvh(exact, mesh.triangles, std::move(with_area), executor);
    const std::vector<HalfEdge> edges = sorted_half_edges(mesh.triangles);
    PreparedMesh measured(mesh);
    measured.report.outward = false; // as for a mesh whose report is not filled yet
    fill_report(measured, find_patches(mesh.triangles, edges), edges, exact, bvh, executor);
    return measured.report;
}

} // namespace raycontact
