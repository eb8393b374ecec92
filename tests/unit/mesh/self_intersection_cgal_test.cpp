// SPDX-License-Identifier: Apache-2.0
// Our exact test against CGAL's, triangle pair by triangle pair.
#include "tests/unit/mesh/solids.h"

#include "mesh/self_intersection.h"

#include <raycontact/mesh.h>

// CGAL's headers are not written for these warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#pragma GCC diagnostic pop

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>
#include <utility>

using namespace raycontact;
using namespace raycontact::test;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using PairSet = std::set<std::pair<std::size_t, std::size_t>>;

PairSet by_cgal(const PreparedMesh& mesh) {
    std::vector<Kernel::Point_3> points;
    for (const Vec3& v : mesh.vertices) points.emplace_back(v.x, v.y, v.z);
    std::vector<std::vector<std::size_t>> triangles;
    for (const auto& [a, b, c] : mesh.triangles) triangles.push_back({a, b, c});
    std::vector<std::pair<std::size_t, std::size_t>> found;
    CGAL::Polygon_mesh_processing::triangle_soup_self_intersections(points, triangles, std::back_inserter(found));
    PairSet pairs;
    for (const auto& [i, k] : found) pairs.insert(std::minmax(i, k));
    return pairs;
}

PairSet by_us(const PreparedMesh& mesh) {
    std::vector<std::uint32_t> all(mesh.triangles.size());
    std::iota(all.begin(), all.end(), 0u);
    PairSet pairs;
    const TriangleBvh bvh(mesh.vertices, mesh.triangles, all);
    bvh.any_pair([&](std::uint32_t i, std::uint32_t k) {
        if (triangles_meet(mesh.vertices, mesh.triangles[i], mesh.triangles[k]))
            pairs.insert(std::minmax<std::size_t>(i, k));
        return false;
    });
    return pairs;
}

std::size_t compare(const Mesh& mesh) {
    const PreparedMesh prepared = prepare_mesh(mesh);
    const PairSet ours = by_us(prepared);
    EXPECT_EQ(ours, by_cgal(prepared)) << mesh.name;
    EXPECT_EQ(prepared.report.self_intersecting, !ours.empty());
    return ours.size();
}

TEST(SelfIntersectionCgal, ToriFromRingToSpindle) {
    std::size_t met = 0;
    for (int i = 0; i < 24; ++i) met += compare(torus(12 + i, 8 + i % 5, 1, 0.2 + 0.06 * i, 0.05 * (i % 4)));
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
