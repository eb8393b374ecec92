// SPDX-License-Identifier: Apache-2.0
// Rays known by a triangle's normal-cone ball meet what a cast says that they meet, and keep to all that the proof asks
// of them (docs/internals/certified.md): what a cast says differs so seldom near the limits that it alone would miss a
// limit left out.
#include "pairs/rounding.h"
#include "property/crowds.h"
#include "scenes/models/model.h"
#include "shape/accelerators.h"
#include "unit/kernels/aimed_ray.h"
#include "unit/shape/accelerated.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

using namespace reference;

struct Counts {
    std::uint64_t rays = 0, known = 0, contacts = 0, outside = 0, stepped = 0, wrong = 0;
    std::uint64_t askew = 0, near_edge = 0, near_surface = 0; ///< known against a premise of the proof
};

// No more than the cosine of the ray and any normal in the normal-cone ball; -1: the ray begins outside. Half of what
// is kept from the rim for rounding may be used up.
double least_facing(const ShapeData& target, std::uint32_t triangle_lane, const Vec3& from, double along,
                    double margin) {
    const auto corner = corners(target, triangle_lane);
    const double far = length((1.0 / 3) * (corner[0] + corner[1] + corner[2]) - from) + 0.5 * margin;
    const auto radii = cap_radii(target, triangle_lane);
    if (far >= radii[1]) return -1;
    const double angle = std::acos(std::min(along, 1.0));
    return std::cos(angle + std::acos(double(far < radii[0] ? CONE_NARROW_COSINE : CONE_WIDE_COSINE)));
}

void count_against_premises(const ShapeData& target, std::uint32_t triangle_lane,
                            const kernels::prototype::SourceRay& ray, double margin, Counts& counts) {
    const double tolerance = double(target.header.tolerance);
    const auto corner = corners(target, triangle_lane);
    const Vec3 p = vec(ray.position), d = (1 / length(vec(ray.direction))) * vec(ray.direction);
    const Vec3 normal = cross(corner[1] - corner[0], corner[2] - corner[0]), n = (1 / length(normal)) * normal;
    const double facing = least_facing(target, triangle_lane, p, dot(n, d), margin);
    counts.askew += !(facing > double(CONE_LEAST_FACING) + 0.5 * double(CONE_LOST_OF_FACING));
    const double t = dot(corner[0] - p, n) / dot(d, n);
    // Of 4 tolerances in the plane of the ray test more than half are left square to the ray.
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 along = corner[(k + 1) % 3] - corner[k], square = cross(along, d);
        counts.near_edge += !(dot(corner[k] - p, square) > 2 * tolerance * length(square));
    }
    counts.near_surface += t < -0.1 * tolerance && !(-t * facing > 3 * tolerance);
}

void examine(const Shape& shape, int rays, Random& random, Counts& counts) {
    const ShapeData target = accelerated(shape);
    PlacedBody body;
    body.shape = &shape;
    const double margin = rounding_margin(body, body);
    const kernels::HeldRange asks = held_range(margin, 0, true);
    for (int i = 0; i < rays; ++i) {
        const auto aimed = aim_at_cone(target, margin, random);
        if (!aimed) continue;
        const kernels::Held held = known_triangle(target, aimed->triangle_lane, random);
        ++counts.rays;
        const auto said = ask(aimed->ray, held, target, asks, random.below(RAYS_IN_GROUP));
        if (!said) continue;
        const kernels::Hit truth = cast(aimed->ray, target);
        ++counts.known;
        counts.contacts += truth.triangle != NONE;
        counts.outside += aimed->depth < 0;
        counts.stepped += said->triangle_lane != held.triangle;
        counts.wrong += differ(said->hit, truth);
        count_against_premises(target, said->triangle_lane, aimed->ray, margin, counts);
    }
}

void expect(const char* name, const Counts& counts) {
    std::printf("[ counts   ] %s: %llu rays, %llu known, of them %llu contacts, %llu from outside, %llu by another "
                "triangle; %llu wrong; %llu askew, %llu too near to an edge, %llu to the surface\n",
                name, static_cast<unsigned long long>(counts.rays), static_cast<unsigned long long>(counts.known),
                static_cast<unsigned long long>(counts.contacts), static_cast<unsigned long long>(counts.outside),
                static_cast<unsigned long long>(counts.stepped), static_cast<unsigned long long>(counts.wrong),
                static_cast<unsigned long long>(counts.askew), static_cast<unsigned long long>(counts.near_edge),
                static_cast<unsigned long long>(counts.near_surface));
    EXPECT_EQ(counts.wrong, 0u);
    EXPECT_EQ(counts.askew, 0u);
    EXPECT_EQ(counts.near_edge, 0u);
    EXPECT_EQ(counts.near_surface, 0u);
    EXPECT_GT(counts.known, counts.rays / 10);
    EXPECT_GT(counts.contacts, counts.rays / 50);
    EXPECT_GT(counts.outside, counts.rays / 50);
    EXPECT_GT(counts.stepped, counts.rays / 100);
}

TEST(NormalCone, DecidesAsACastDoes) {
    Random random(12);
    for (const char* kind : {"sphere", "torus", "knot"}) {
        Counts counts;
        const auto shape = Shape::make(scenes::scene_model(kind, 4000).mesh);
        EXPECT_NE(accelerated(*shape).header.cones_pay, 0u) << kind;
        examine(*shape, 150000, random, counts);
        expect(kind, counts);
    }
}

// Coarse meshes have few normal-cone balls, and `certified` does not ask them; what is said is as true.
TEST(NormalCone, OfCoarseMeshesToo) {
    Random random(13);
    for (const Kind kind : {Kind::concave, Kind::cavities, Kind::slivers}) {
        Counts counts;
        for (const auto& shape : crowd_shapes(kind, 1)) examine(*shape, 60000, random, counts);
        expect(name_of(kind), counts);
    }
}

TEST(NormalCone, NothingIsSaidWhereTheInsideIsNotKnown) {
    for (const Kind kind : {Kind::open, Kind::crossing})
        for (const auto& shape : crowd_shapes(kind, 1)) {
            if (shape->data().header.outward != 0) continue;
            shape->prepare();
            EXPECT_EQ(accelerators_of(*shape)->header.cones_pay, 0u);
            EXPECT_TRUE(accelerators_of(*shape)->normal_cones.empty());
        }
}

} // namespace
} // namespace raycontact
