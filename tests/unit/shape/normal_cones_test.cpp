// SPDX-License-Identifier: Apache-2.0
// In a triangle's normal-cone ball no triangle turns away farther than is said, by brute force; normal-cone balls are
// not much smaller than they could be, and none is missing.
#include "mesh/vector.h"
#include "property/crowds.h"
#include "reference/margins.h"
#include "reference/meshes.h"
#include "scenes/models/model.h"
#include "shape/accelerators.h"
#include "unit/shape/accelerated.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

using namespace reference;

struct Counts {
    std::uint64_t triangles = 0, narrow = 0, wide = 0, beyond = 0, small = 0, missing = 0;
};

void examine(const Shape& shape, std::uint32_t triangles, Random& random, Counts& counts) {
    const ShapeData data = accelerated(shape);
    const auto corner = [&](std::uint32_t t, std::size_t c) {
        const Point3f& p = data.points[data.mesh.triangles[t][c]];
        return Vec3{p.x, p.y, p.z};
    };
    const auto normal = [&](std::uint32_t t) {
        const Vec3 n = cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
        const double size = length(n);
        return size > 0 ? (1 / size) * n : Vec3{};
    };
    std::vector<Solid> alone; // so that each triangle's distance is the reference's
    for (std::uint32_t t = 0; t < data.faces.size(); ++t)
        alone.push_back(make_surface("one", {corner(t, 0), corner(t, 1), corner(t, 2)}, {{0, 1, 2}}));
    const double tolerance = double(data.header.tolerance);
    const double unit = double(CONE_UNIT_TOLERANCES) * tolerance, most = 65535 * unit;
    const auto count = static_cast<std::uint32_t>(data.mesh.triangles.size());
    for (std::uint32_t i = 0; i < std::min(triangles, count); ++i) {
        const std::uint32_t t = triangles < count ? random.below(count) : i;
        const std::uint32_t triangle_lane = data.faces[t].triangle_lane;
        if (triangle_lane == NONE) continue;
        const std::uint32_t cone = kernels::at_place<std::uint32_t>(nullptr, data.header.normal_cones)[triangle_lane];
        const Vec3 centre = (1.0 / 3) * (corner(t, 0) + corner(t, 1) + corner(t, 2)), n = normal(t);
        ++counts.triangles;
        counts.narrow += (cone & 0xffffu) != 0;
        counts.wide += cone >> 16 != 0;
        const double own =
            std::max({length(corner(t, 0) - centre), length(corner(t, 1) - centre), length(corner(t, 2) - centre)});
        const double longest = std::max({length(corner(t, 1) - corner(t, 0)), length(corner(t, 2) - corner(t, 1)),
                                         length(corner(t, 0) - corner(t, 2))});
        const double height =
            length(cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0))) / longest / tolerance;
        const double radii[2] = {double(cone & 0xffffu) * unit, double(cone >> 16) * unit};
        const float cosines[2] = {CONE_NARROW_COSINE, CONE_WIDE_COSINE};
        EXPECT_LE(radii[0], radii[1]);
        for (int k = 0; k < 2; ++k) {
            double nearest = most;
            for (std::uint32_t other = 0; other < count; ++other) {
                if (data.faces[other].triangle_lane == NONE || dot(normal(other), n) > double(cosines[k]) + 1e-9)
                    continue;
                nearest = std::min(nearest, distance_to_surface(alone[other], centre));
            }
            if (radii[k] > 0) {
                EXPECT_GT(radii[k], own + 11.9 * tolerance);
                // A step is kept for the centre that float32 finds.
                counts.beyond += radii[k] + 0.999 * unit > nearest;
                counts.small += radii[k] < nearest - 3 * unit;
            } else if (height > 64.1) {
                counts.missing += nearest > own + 16.1 * tolerance;
            }
        }
    }
}

TEST(NormalCones, HoldNothingThatTurnsAway) {
    Random random(5);
    Counts counts;
    for (const Kind kind : {Kind::concave, Kind::cavities, Kind::slivers, Kind::sizes})
        for (const auto& shape : crowd_shapes(kind, 1))
            if (shape->triangles().size() < 2000) examine(*shape, 200, random, counts);
    for (const char* kind : {"sphere", "torus", "knot"})
        examine(*Shape::make(scenes::scene_model(kind, 4000).mesh), 400, random, counts);
    std::printf("[ counts   ] %llu triangles, %llu with a narrow normal-cone ball, %llu with a wide one; %llu reach "
                "beyond, %llu are "
                "too small, %llu are missing\n",
                static_cast<unsigned long long>(counts.triangles), static_cast<unsigned long long>(counts.narrow),
                static_cast<unsigned long long>(counts.wide), static_cast<unsigned long long>(counts.beyond),
                static_cast<unsigned long long>(counts.small), static_cast<unsigned long long>(counts.missing));
    EXPECT_EQ(counts.beyond, 0u);
    EXPECT_EQ(counts.small, 0u);
    EXPECT_EQ(counts.missing, 0u);
    EXPECT_GT(counts.narrow, counts.triangles / 8);
    EXPECT_GT(counts.wide, counts.triangles / 4);
}

// A triangle in the middle of a box's face, cut in three by a point near one of its edges.
std::uint32_t cap_of_needle(double height) {
    Mesh mesh = grid_box_mesh(8);
    std::size_t middle = 0;
    const auto corner = [&](std::size_t t, std::size_t k) { return mesh.vertices[mesh.triangles[t][k]]; };
    const auto centre = [&](std::size_t t) { return (1.0 / 3) * (corner(t, 0) + corner(t, 1) + corner(t, 2)); };
    const Vec3 aim{0.5, 0.5, 1};
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if (length(centre(t) - aim) < length(centre(middle) - aim)) middle = t;
    const auto [a, b, c] = mesh.triangles[middle];
    const double tolerance = double(Shape::make(mesh)->data().header.tolerance);
    const Vec3 on = 0.5 * (corner(middle, 0) + corner(middle, 1)), in = corner(middle, 2) - on;
    const Vec3 along = corner(middle, 1) - corner(middle, 0);
    const double square = length(cross(along, in)) / length(along);
    mesh.vertices.push_back(on + (height * tolerance / square) * in);
    const auto m = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    mesh.triangles[middle] = {a, b, m};
    mesh.triangles.push_back({b, c, m});
    mesh.triangles.push_back({c, a, m});
    const auto shape = Shape::make(mesh);
    EXPECT_NE(shape->data().header.outward, 0u);
    const std::uint32_t triangle_lane = shape->data().faces[middle].triangle_lane;
    shape->prepare();
    return accelerators_of(*shape)->normal_cones[triangle_lane];
}

TEST(NormalCones, NeedlesHaveNone) {
    EXPECT_EQ(cap_of_needle(48), 0u) << "float32 may not find its normal";
    EXPECT_NE(cap_of_needle(80), 0u);
}

} // namespace
} // namespace raycontact
