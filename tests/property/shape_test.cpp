// SPDX-License-Identifier: Apache-2.0
// What a shape precomputes per vertex against the reference: normals, exit distances, and the plain facts of its box.
#include "property/shapes.h"
#include "reference/exits.h"
#include "reference/meshes.h"
#include "reference/vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

struct Counts {
    int vertices = 0, finite = 0, infinite = 0, zero = 0, excused = 0;
    double worst_normal = 0, worst_exit = 0, worst_area = 0;
};

void expect_shape(const Subject& subject, Counts& counts) {
    const Shape& shape = *subject.shape;
    const Solid& solid = subject.solid;
    SCOPED_TRACE(solid.name);
    ASSERT_EQ(shape.vertex_normals().size(), solid.vertices.size());
    ASSERT_EQ(shape.exit_distances().size(), solid.vertices.size());
    EXPECT_EQ(shape.report().closed, solid.closed);
    EXPECT_LT(length(shape.box_min() - shape.centre() - solid.box_min), 1e-6 * solid.diagonal);
    EXPECT_LT(length(shape.box_max() - shape.centre() - solid.box_max), 1e-6 * solid.diagonal);
    ASSERT_EQ(shape.vertex_areas().size(), solid.vertices.size());
    double radius = 0, area = 0;
    for (std::size_t v = 0; v < solid.vertices.size(); ++v) {
        radius = std::max(radius, length(shape.vertices()[v]));
        ++counts.vertices;
        if (solid.cancellation[v] > 1e-3) {
            const double off = length(shape.vertex_normals()[v] - solid.vertex_normals[v]);
            EXPECT_LT(off, 1e-5) << "normal of vertex " << v;
            counts.worst_normal = std::max(counts.worst_normal, off);
        }
        const double share = shape.vertex_areas()[v], wrong = std::fabs(share - solid.vertex_areas[v]);
        EXPECT_LT(wrong, 1e-6 * solid.vertex_areas[v]) << "area of vertex " << v;
        counts.worst_area = std::max(counts.worst_area, wrong / solid.vertex_areas[v]);
        area += share;
        const double exit = shape.exit_distances()[v];
        const double expected = solid.exits[v];
        const bool both_infinite = std::isinf(exit) && std::isinf(expected);
        const double off = both_infinite ? 0 : std::fabs(exit - expected) / solid.diagonal;
        if (off < 1e-5) {
            counts.worst_exit = std::max(counts.worst_exit, off);
        } else if (solid.exit_margins[v] < 1e-5) {
            ++counts.excused;
        } else {
            ADD_FAILURE() << "exit distance of vertex " << v << ": " << exit << ", the reference has " << expected
                          << ", margin " << solid.exit_margins[v];
        }
        (std::isinf(expected) ? counts.infinite : expected > 0 ? counts.finite : counts.zero) += 1;
    }
    EXPECT_NEAR(area, shape.report().area, 1e-5 * area);
    EXPECT_NEAR(shape.radius(), radius, 1e-6 * solid.diagonal);
    EXPECT_GE(shape.radius(), radius * (1 - 1e-12)) << "motion would be underestimated";
}

void report(const Counts& c) {
    std::printf("[ counts   ] %d vertices: %d finite exits, %d infinite, %d zero; %d excused; worst normal %.2g, exit "
                "%.2g, area %.2g\n",
                c.vertices, c.finite, c.infinite, c.zero, c.excused, c.worst_normal, c.worst_exit, c.worst_area);
}

TEST(shape, normals_and_exit_distances_of_the_closed_meshes) {
    Counts counts;
    for (const Subject& s : closed_subjects()) expect_shape(s, counts);
    report(counts);
    EXPECT_GE(counts.vertices, 2000);
    EXPECT_GE(counts.finite, 2000);
    EXPECT_LE(counts.excused, counts.vertices / 500);
}

TEST(shape, normals_and_exit_distances_of_the_open_meshes) {
    Counts counts;
    for (const Subject& s : open_subjects()) expect_shape(s, counts);
    report(counts);
    EXPECT_GE(counts.vertices, 160);
    EXPECT_GE(counts.infinite, 50);
    EXPECT_LE(counts.excused, 2);
}

TEST(shape, exit_is_zero_where_the_inward_normal_points_out) {
    Random random(7);
    Counts counts;
    for (int k = 0; k < 1000; ++k) {
        expect_shape(Subject(crooked_pyramid_mesh(random)), counts);
    }
    report(counts);
    EXPECT_GE(counts.zero, 5);
    EXPECT_LE(counts.excused, counts.vertices / 500);
}

TEST(shape, far_from_its_origin_keeps_its_form) {
    const Vec3 far{10000, -20000, 5000};
    for (const Mesh& mesh : {bumpy_octahedron_mesh(6), l_prism_mesh()}) {
        const Subject near(mesh);
        const Subject away(moved(mesh, far));
        ASSERT_EQ(near.solid.vertices.size(), away.solid.vertices.size());
        for (std::size_t v = 0; v < near.solid.vertices.size(); ++v) {
            EXPECT_LT(length(away.shape->vertices()[v] - near.shape->vertices()[v] - far), 2e-7);
            EXPECT_LT(length(away.shape->vertex_normals()[v] - near.shape->vertex_normals()[v]), 1e-5);
            EXPECT_NEAR(away.shape->exit_distances()[v], near.shape->exit_distances()[v], 1e-5);
        }
        Counts counts;
        expect_shape(away, counts);
        EXPECT_EQ(counts.excused, 0);
    }
}

} // namespace
