// SPDX-License-Identifier: Apache-2.0
// Our exact test against CGAL: every pair of triangles by exact intersection, whole solids by its own self-intersection
// test.
#include "tests/unit/mesh/solids.h"

#include "mesh/predicates.h"
#include "mesh/self_intersection.h"

#include <raycontact/mesh.h>

// CGAL's headers are not written for these warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#pragma GCC diagnostic pop
// After CGAL, which has names that are macros in our kernels.
#include "mesh/mesh_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <utility>

using namespace raycontact;
using namespace raycontact::test;

namespace {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Inexact = CGAL::Exact_predicates_inexact_constructions_kernel;
using PairSet = std::set<std::pair<std::size_t, std::size_t>>;

/// Whether two triangles have more in common than the vertices or the edge they share.
bool meet_by_cgal(const std::vector<Exact::Point_3>& points, const Triangle& a, const Triangle& b) {
    std::vector<Exact::Point_3> shared;
    for (const std::uint32_t v : a) {
        if (std::find(b.begin(), b.end(), v) != b.end()) shared.push_back(points[v]);
    }
    if (shared.size() == 3) return true;
    const Exact::Triangle_3 p(points[a[0]], points[a[1]], points[a[2]]), q(points[b[0]], points[b[1]], points[b[2]]);
    if (!CGAL::do_intersect(p.bbox(), q.bbox())) return false;
    const auto common = CGAL::intersection(p, q);
    if (!common) return false;
    if (shared.empty()) return true;
    if (const auto* point = boost::get<Exact::Point_3>(&*common)) return *point != shared[0];
    if (const auto* segment = boost::get<Exact::Segment_3>(&*common)) {
        if (shared.size() == 1) return true;
        return *segment != Exact::Segment_3(shared[0], shared[1]) && *segment != Exact::Segment_3(shared[1], shared[0]);
    }
    return true; // an area
}

/// A repair may keep triangles without area, where a closed edge needs them; CGAL takes none.
std::vector<std::uint32_t> with_area(const PreparedMesh& mesh) {
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto [a, b, c] = mesh.triangles[i];
        if (!collinear(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c])) chosen.push_back(i);
    }
    return chosen;
}

PairSet by_cgal(const PreparedMesh& mesh) {
    std::vector<Exact::Point_3> points;
    for (const Vec3& v : mesh.vertices) points.emplace_back(v.x, v.y, v.z);
    PairSet pairs;
    const std::vector<std::uint32_t> chosen = with_area(mesh);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        for (std::size_t k = i + 1; k < chosen.size(); ++k) {
            if (meet_by_cgal(points, mesh.triangles[chosen[i]], mesh.triangles[chosen[k]]))
                pairs.insert({chosen[i], chosen[k]});
        }
    }
    return pairs;
}

bool solid_intersects_by_cgal(const PreparedMesh& mesh) {
    CGAL::Surface_mesh<Inexact::Point_3> surface;
    std::vector<CGAL::Surface_mesh<Inexact::Point_3>::Vertex_index> ids;
    for (const Vec3& v : mesh.vertices) ids.push_back(surface.add_vertex({v.x, v.y, v.z}));
    for (const auto& [a, b, c] : mesh.triangles) surface.add_face(ids[a], ids[b], ids[c]);
    EXPECT_EQ(surface.number_of_faces(), mesh.triangles.size());
    return CGAL::Polygon_mesh_processing::does_self_intersect(surface);
}

PairSet by_us(const PreparedMesh& mesh) {
    PairSet pairs;
    Executor one_thread(1);
    const MeshTree tree(mesh.vertices, mesh.triangles, with_area(mesh), one_thread);
    tree.any_pair(one_thread, [&](std::uint32_t i, std::uint32_t k) {
        if (triangles_meet(mesh.vertices, mesh.triangles[i], mesh.triangles[k]))
            pairs.insert(std::minmax<std::size_t>(i, k));
        return false;
    });
    return pairs;
}

std::size_t compare(const Mesh& mesh) {
    const PreparedMesh prepared = prepare_mesh(mesh, {.overlaps = Overlaps::leave});
    const PairSet ours = by_us(prepared);
    EXPECT_EQ(ours, by_cgal(prepared)) << mesh.name;
    EXPECT_EQ(prepared.report.self_intersecting, !ours.empty());
    return ours.size();
}

TEST(SelfIntersectionCgal, ToriFromRingToSpindle) {
    std::size_t met = 0;
    for (int i = 0; i < 24; i += 3) {
        const Mesh mesh = torus(12 + static_cast<std::uint32_t>(i), 8 + static_cast<std::uint32_t>(i % 5), 1,
                                0.2 + 0.06 * i, 0.05 * (i % 4));
        const PreparedMesh prepared = prepare_mesh(mesh, {.overlaps = Overlaps::leave});
        EXPECT_EQ(prepared.report.self_intersecting, solid_intersects_by_cgal(prepared));
        met += compare(mesh);
    }
    EXPECT_GT(met, 100u);
}

TEST(SelfIntersectionCgal, ManyCoplanarAndTouchingFaces) {
    Mesh mesh = box();
    append_box(mesh, {1, 0, 0}, {2, 1, 1});             // a common face, the other way round
    append_box(mesh, {0.25, 0.25, 1}, {0.75, 0.75, 2}); // stands on a face
    append_box(mesh, {0.5, 0.5, 0.5}, {3, 3, 3});       // overlaps all of them
    append_box(mesh, {-1, -1, -1}, {0, 0, 0});          // a common vertex
    EXPECT_GT(compare(mesh), 20u);
}

TEST(SelfIntersectionCgal, RandomSoupOnACoarseGrid) {
    // Small whole coordinates: shared vertices, touching edges and coplanar overlaps of every kind.
    std::mt19937 random(7);
    std::size_t met = 0;
    for (int round = 0; round < 200; ++round) {
        Mesh mesh{"soup " + std::to_string(round), {}, {}};
        for (std::uint32_t i = 0; i < 24; ++i) {
            for (int k = 0; k < 3; ++k) {
                const auto coordinate = [&] { return static_cast<double>(random() % 4); };
                const double x = coordinate(), y = coordinate();
                mesh.vertices.push_back({x, y, round % 2 ? 0.1 * (x + y) : coordinate()});
            }
            mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
        }
        met += compare(mesh);
    }
    EXPECT_GT(met, 1000u);
}

} // namespace
