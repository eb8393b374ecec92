// SPDX-License-Identifier: Apache-2.0
#include <raycontact/error.h>
#include <raycontact/mass.h>
#include <raycontact/mesh.h>

#include "executor/float_environment.h"
#include "mesh/adjacency.h"
#include "mesh/check.h"
#include "mesh/input_file.h"
#include "mesh/measure.h"
#include "mesh/nesting.h"
#include "mesh/patches.h"
#include "mesh/predicates.h"
#include "mesh/repair.h"
#include "mesh/self_intersection.h"
#include "mesh/weld.h"

#include <cmath>
#include <utility>

namespace raycontact {
namespace {

[[noreturn]] void fail(const Mesh& mesh, const std::string& what) {
    throw InputError((mesh.name.empty() ? "mesh" : printable(mesh.name)) + ": " + what);
}

void check_input(const Mesh& mesh) {
    // Products of four coordinates must fit float32, with which rays are cast.
    constexpr double furthest = 1e9;
    if (mesh.triangles.empty()) fail(mesh, "has no triangles");
    if (mesh.triangles.size() >= 0xffffffffu / 3 || mesh.vertices.size() >= 0xffffffffu) {
        fail(mesh, "has more triangles than 32-bit indices can name; split or reduce it");
    }
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const Vec3& v = mesh.vertices[i];
        const double reach = std::max(std::fabs(v.x), std::max(std::fabs(v.y), std::fabs(v.z)));
        if (!std::isfinite(v.x + v.y + v.z)) fail(mesh, "vertex " + std::to_string(i) + " is not finite");
        if (reach > furthest)
            fail(mesh, "vertex " + std::to_string(i) + " is further than 1e9 m from the origin; scale the mesh");
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (const std::uint32_t v : mesh.triangles[i]) {
            if (v >= mesh.vertices.size()) {
                fail(mesh, "triangle " + std::to_string(i) + ": vertex index " + std::to_string(v) + " is not in 0 to "
                               + std::to_string(mesh.vertices.size()) + " - 1");
            }
        }
    }
}

/// The triangles of the file over file vertices, the lowest of each place.
PreparedMesh weld(const Mesh& mesh) {
    PreparedMesh prepared;
    prepared.name = mesh.name;
    const std::vector<std::uint32_t> lowest = lowest_at_same_place(mesh.vertices);
    prepared.triangles.reserve(mesh.triangles.size());
    prepared.triangle_index.reserve(mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto [a, b, c] = mesh.triangles[i];
        prepared.triangles.push_back({lowest[a], lowest[b], lowest[c]});
        prepared.triangle_index.push_back(static_cast<std::uint32_t>(i));
    }
    return prepared;
}

/// From file vertices to the distinct ones in use.
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

void fill_report(const Mesh& mesh, PreparedMesh& prepared, const std::vector<Vec3>& snapped_vertices,
                 const TriangleBvh& bvh) {
    MeshReport& report = prepared.report;
    report.vertices = prepared.vertices.size();
    report.triangles = prepared.triangles.size();
    report.file_vertices = mesh.vertices.size();
    report.file_triangles = mesh.triangles.size();
    const std::vector<HalfEdge> edges = sorted_half_edges(prepared.triangles);
    const Topology topology =
        check_topology(prepared.triangles, edges, static_cast<std::uint32_t>(prepared.vertices.size()));
    report.closed = topology.closed;
    report.manifold = topology.manifold;
    report.oriented = topology.oriented;
    report.components = topology.components;
    report.self_intersecting = self_intersects(snapped_vertices, prepared.triangles, bvh);
    if (report.closed && report.oriented && !report.self_intersecting) {
        report.outward =
            winds_outward(prepared.vertices, prepared.triangles, find_patches(prepared.triangles, edges), bvh);
    }
    report.volume = report.closed ? mass_of(prepared.vertices, prepared.triangles).volume : 0;
    report.area = area_of(prepared.vertices, prepared.triangles);
    const Box box = box_of(prepared.vertices);
    report.box_min = box.low;
    report.box_max = box.high;
}

} // namespace

PreparedMesh prepare_mesh(const Mesh& mesh, Repair repair) {
    const FloatEnvironment environment; // the predicates need rounding to nearest
    check_input(mesh);
    PreparedMesh prepared = weld(mesh);
    std::vector<Vec3> exact(mesh.vertices.size());
    for (std::size_t i = 0; i < exact.size(); ++i) exact[i] = snapped(mesh.vertices[i]);
    if (repair == Repair::allowed) {
        drop_degenerate(prepared, exact);
        drop_duplicates(prepared);
    }
    number_vertices(mesh, prepared);
    exact.clear();
    for (const Vec3& v : prepared.vertices) exact.push_back(snapped(v));

    std::vector<std::uint32_t> with_area;
    for (std::uint32_t i = 0; i < prepared.triangles.size(); ++i) {
        if (!is_degenerate(prepared.triangles[i], exact)) with_area.push_back(i);
    }
    if (with_area.empty()) fail(mesh, "no triangle has an area");
    const TriangleBvh bvh(exact, prepared.triangles, std::move(with_area));
    if (repair == Repair::allowed) mend_windings(prepared, bvh);
    fill_report(mesh, prepared, exact, bvh);
    return prepared;
}

} // namespace raycontact
