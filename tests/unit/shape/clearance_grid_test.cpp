// SPDX-License-Identifier: Apache-2.0
// What a look-up says about the distance to a surface is never more than the distance, and outside is outside.
#include "property/crowds.h"
#include "reference/margins.h"
#include "reference/meshes.h"
#include "reference/side.h"
#include "reference/vector.h"
#include "unit/shape/accelerated.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>

namespace raycontact {
namespace {

using namespace reference;

struct Lookup {
    float distance[VERTEX_LANES]; ///< certain to be free of surface
    bool outside[VERTEX_LANES];
};

// By the kernel itself: points given as the vertices of a source that stands in the target's frame.
Lookup look_up(const ShapeData& target, const Point3f (&points)[VERTEX_LANES]) {
    kernels::DirectedPair pair{};
    pair.rotation[0] = pair.rotation[4] = pair.rotation[8] = 1;
    // Endless bounds: no vertex is safe by being outside them.
    std::fill(pair.bounds, pair.bounds + 3, -UNBOUNDED);
    std::fill(pair.bounds + 3, pair.bounds + 6, UNBOUNDED);
    kernels::VertexBlock block{};
    for (std::size_t k = 0; k < VERTEX_LANES; ++k) {
        block.position[0][k] = points[k].x;
        block.position[1][k] = points[k].y;
        block.position[2][k] = points[k].z;
        block.vertex[k] = std::isnan(points[k].x) ? NONE : static_cast<kernels::uint>(k);
    }
    Lookup found{};
    const auto seen = kernels::prototype::inside_lanes(&pair, &block, 0);
    const auto find_safe = [&](float* safe) {
        kernels::prototype::safe_lanes(safe, &seen, &pair, &block, 0, &target.header, nullptr);
    };
    float near[VERTEX_LANES], endless[VERTEX_LANES];
    find_safe(near);
    std::copy(near, near + VERTEX_LANES, found.distance);
    // A vertex that is not certainly outside loses its ray's reach; one with an endless ray is never safe.
    std::fill(block.exit, block.exit + VERTEX_LANES, std::numeric_limits<float>::infinity());
    find_safe(endless);
    for (std::size_t k = 0; k < VERTEX_LANES; ++k) found.outside[k] = endless[k] >= 0;
    return found;
}

struct Counts {
    std::uint64_t points = 0, known_outside = 0, truly_outside = 0, wrong_side = 0;
    double most_over = -1e300;           ///< certificate less distance, in diagonals of the mesh
    double near_sum = 0, near_share = 0; ///< outside points within half a diagonal: how much of it was certified
};

void examine(const Shape& shape, int rounds, Random& random, Counts& counts) {
    const ShapeData data = accelerated(shape);
    const Solid solid = make_surface(shape);
    const Vec3 size = solid.box_max - solid.box_min;
    for (int round = 0; round < rounds; ++round) {
        Point3f points[VERTEX_LANES];
        for (Point3f& point : points) {
            Vec3 p;
            const std::uint32_t how = random.below(4);
            if (how == 0) { // on or near the surface
                const auto& [a, b, c] =
                    solid.triangles[random.below(static_cast<std::uint32_t>(solid.triangles.size()))];
                const double u = random.uniform(), v = random.uniform();
                p = solid.vertices[a] + u * (solid.vertices[b] - solid.vertices[a])
                    + (1 - u) * v * (solid.vertices[c] - solid.vertices[a])
                    + std::pow(10.0, random.uniform(-7, -1)) * solid.diagonal * random.direction();
            } else if (how == 1) { // far and near around the box
                p = std::pow(10.0, random.uniform(-1, 2)) * solid.diagonal * random.in_ball();
            } else { // in the box, its faces among it
                const auto part = [&] { return random.below(6) == 0 ? random.below(2) : random.uniform(); };
                const double x = part(), y = part(), z = part();
                p = solid.box_min + Vec3{x * size.x, y * size.y, z * size.z};
            }
            point = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
        }
        const Lookup found = look_up(data, points);
        for (std::size_t k = 0; k < VERTEX_LANES; ++k) {
            const Vec3 p{points[k].x, points[k].y, points[k].z};
            const double distance = distance_to_surface(solid, p);
            ++counts.points;
            counts.most_over =
                std::max(counts.most_over, (double(found.distance[k]) - distance) / (solid.diagonal + length(p)));
            if (data.header.outward == 0) {
                counts.wrong_side += found.outside[k]; // nothing is outside of such a mesh
                continue;
            }
            const bool outside = winding_number(solid, p) < 0.5;
            counts.known_outside += found.outside[k];
            counts.truly_outside += outside;
            counts.wrong_side += found.outside[k] && !outside && distance > 1e-6 * solid.diagonal;
            if (outside && distance < 0.5 * solid.diagonal && distance > 0.01 * solid.diagonal) {
                counts.near_sum += 1;
                counts.near_share += std::max(0.0, double(found.distance[k])) / distance;
            }
        }
    }
}

TEST(ClearanceGrid, CertifiesNoMoreThanTheDistance) {
    Random random(1);
    for (const Kind kind : kinds) {
        Counts c;
        for (const double scale : {1.0, 1e-3, 100.0})
            for (const auto& shape : crowd_shapes(kind, scale)) examine(*shape, 60, random, c);
        std::printf(
            "[ counts   ] %s: %llu points, certificates over the distance by %.2g diagonals at most, %.0f %% of "
            "it near by; %llu of %llu known to be outside, %llu wrongly\n",
            name_of(kind), static_cast<unsigned long long>(c.points), c.most_over,
            c.near_sum > 0 ? 100 * c.near_share / c.near_sum : 0.0, static_cast<unsigned long long>(c.known_outside),
            static_cast<unsigned long long>(c.truly_outside), static_cast<unsigned long long>(c.wrong_side));
        EXPECT_LT(c.most_over, 1e-6) << name_of(kind); // a tenth of what the method allows for
        EXPECT_EQ(c.wrong_side, 0u) << name_of(kind);
        if (c.truly_outside > 0) {
            EXPECT_GT(c.near_share, 0.3 * c.near_sum) << name_of(kind) << ": hardly worth its memory";
        }
    }
}

// Nested closed shells: the hollow inside is not the outside, though its winding number is that of the outside.
TEST(ClearanceGrid, AHollowIsNotOutside) {
    const auto& shapes = crowd_shapes(Kind::cavities, 1);
    ASSERT_EQ(shapes[1]->data().header.outward, 1u);
    const Point3f middle[VERTEX_LANES] = {};
    const Lookup found = look_up(accelerated(*shapes[1]), middle);
    EXPECT_FALSE(found.outside[0]);
    EXPECT_GT(found.distance[0], 0.1f);
}

// A vertex that is no number, of an empty lane, is never due and never inside.
TEST(ClearanceGrid, EmptyLanesAreSafe) {
    const auto shape = Shape::make(l_prism_mesh());
    Point3f nothing[VERTEX_LANES];
    std::fill(std::begin(nothing), std::end(nothing), Point3f{NAN, NAN, NAN});
    EXPECT_EQ(look_up(accelerated(*shape), nothing).distance[3], UNBOUNDED);
}

} // namespace
} // namespace raycontact
