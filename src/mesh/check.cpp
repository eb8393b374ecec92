// SPDX-License-Identifier: Apache-2.0
#include "mesh/check.h"

#include <raycontact/error.h>

#include "mesh/disjoint_sets.h"
#include "mesh/input_file.h"
#include "mesh/nesting.h"
#include "mesh/self_intersection.h"
#include "real_text.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace raycontact {
namespace {

/// Whether the mesh is closed, manifold and oriented, and its number of components.
void fill_topology(MeshReport& report, std::span<const Triangle> triangles, std::span<const HalfEdge> edges) {
    report.manifold = report.oriented = true;
    report.border_edges = 0;
    // Corners of triangles that follow each other around a vertex end in one set: a fan.
    std::size_t fan_count = 3 * triangles.size();
    DisjointSets fans, components;
    fans.reset(fan_count);
    components.reset(report.vertices);
    report.components = report.vertices;
    const auto corner_at = [&](const HalfEdge& side, std::uint32_t vertex) {
        const std::uint32_t start = side.corner, end = side.corner - side.corner % 3 + (side.corner % 3 + 1) % 3;
        return triangles[side.triangle()][start % 3] == vertex ? start : end;
    };
    for_each_edge(edges, [&](std::span<const HalfEdge> sides) {
        int balance = 0;
        for (const HalfEdge& side : sides) {
            balance += side.forward ? 1 : -1;
            if (&side == &sides[0]) continue;
            if (fans.join(corner_at(side, side.lo), corner_at(sides[0], side.lo))) --fan_count;
            if (fans.join(corner_at(side, side.hi), corner_at(sides[0], side.hi))) --fan_count;
        }
        report.border_edges += sides.size() % 2;
        report.manifold = report.manifold && sides.size() <= 2;
        // As many sides run one way as the other; of an odd number one is left over. A border always agrees.
        report.oriented = report.oriented && std::abs(balance) <= static_cast<int>(sides.size() % 2);
        if (components.join(sides[0].lo, sides[0].hi)) --report.components;
    });
    report.closed = report.border_edges == 0;
    report.manifold = report.manifold && fan_count == report.vertices;
}

} // namespace

void check_mesh(const Mesh& mesh, const std::string& name) {
    const auto fail = [&](const std::string& what) { throw InputError(name + ": " + what); };
    if (mesh.triangles.empty()) fail("has no triangles; export a triangle mesh");
    if (mesh.triangles.size() > most_triangles || mesh.vertices.size() > most_vertices)
        fail("has more than " + std::to_string(most_triangles) + " triangles or " + std::to_string(most_vertices)
             + " vertices; split or reduce it");
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        if (!is_finite(mesh.vertices[i])) fail("vertex " + std::to_string(i) + " is not finite");
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (const std::uint32_t v : mesh.triangles[i]) {
            if (v >= mesh.vertices.size())
                fail("triangle " + std::to_string(i) + ": " + no_vertex(v, mesh.vertices.size()));
        }
    }
}

void check_size(std::span<const Vec3> vertices, const std::string& name) {
    const Box box = box_of(vertices);
    for (const double end : {box.low.x, box.low.y, box.low.z, box.high.x, box.high.y, box.high.z}) {
        if (std::fabs(end) > 1.001 * greatest_coordinate) // a recorded one may be off by a rounding
            throw InputError(name + ": reaches further than 1e9 m from the origin; scale the mesh");
    }
    const Vec3 extent = box.high - box.low;
    const double longest = std::max({extent.x, extent.y, extent.z});
    if (longest >= least_size) return;
    throw InputError(name + ": its box is " + text_of(longest) + " m long, less than the " + text_of(least_size)
                     + " m that rays need; scale the mesh");
}

void fill_report(PreparedMesh& prepared, std::span<const HalfEdge> edges) {
    MeshReport& report = prepared.report;
    report.vertices = prepared.vertices.size();
    report.triangles = prepared.triangles.size();
    fill_topology(report, prepared.triangles, edges);
    report.volume = report.closed ? volume_of(prepared.vertices, prepared.triangles) : 0;
    LongSum area;
    for (const auto& [a, b, c] : prepared.triangles) {
        const Vec3& corner = prepared.vertices[a];
        area.add(length(cross(prepared.vertices[b] - corner, prepared.vertices[c] - corner)) / 2);
    }
    report.area = area.value();
    const Box box = box_of(prepared.vertices);
    report.box_min = box.low;
    report.box_max = box.high;
}

void check_surface(PreparedMesh& prepared, const Patches& patches, std::span<const Vec3> snapped_vertices,
                   const TriangleBvh& bvh, Executor& executor) {
    MeshReport& report = prepared.report;
    report.self_intersecting = bvh.any_pair(executor, [&](std::uint32_t i, std::uint32_t k) { // typically O(n log n)
        return triangles_meet(snapped_vertices, prepared.triangles[i], prepared.triangles[k]);
    });
    report.outward =
        report.closed && report.oriented && !report.self_intersecting && winds_outward(prepared, patches, bvh);
    report.checked = true;
}

} // namespace raycontact
