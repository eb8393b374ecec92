// SPDX-License-Identifier: Apache-2.0
// Rays known by a triangle's cap meet what a cast says that they meet: rays that begin in it, at its end and beyond,
// turned by any angle, through every part of the triangle and of its neighbours, and near enough to the surface, to
// edges and to the angle at which triangles no longer face alike that some roundings decide.
#include "pairs/rounding.h"
#include "property/crowds.h"
#include "reference/margins.h"
#include "scenes/models/model.h"
#include "unit/rays/asked_ray.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

using namespace reference;

struct Counts {
    std::uint64_t rays = 0, known = 0, contacts = 0, outside = 0, stepped = 0, wrong = 0;
};

double any_length(double least, double most, Random& random) {
    return least * std::pow(most / least, random.uniform());
}

void examine(const Shape& shape, int rays, Random& random, Counts& counts) {
    const ShapeData& target = shape.data();
    PlacedBody body;
    body.shape = &shape;
    const auto margin = static_cast<float>(rounding_margin(body, body));
    const double tolerance = double(target.header.tolerance), unit = double(CAP_UNIT_TOLERANCES) * tolerance;
    for (int i = 0; i < rays; ++i) {
        const std::uint32_t t = random.below(static_cast<std::uint32_t>(target.faces.size()));
        const std::uint32_t slot = target.faces[t].slot;
        if (slot == NONE) continue;
        const std::uint32_t cap = target.triangle_blocks[slot / TRIANGLE_LANES].cap[slot % TRIANGLE_LANES];
        const bool narrow = random.below(2) == 0;
        const double radius = double(narrow ? cap & 0xffffu : cap >> 16) * unit;
        if (!(radius > 0)) continue;
        const auto corner = [&](std::size_t c) {
            const Point3f& p = target.points[target.mesh.triangles[t][c]];
            return Vec3{p.x, p.y, p.z};
        };
        const Vec3 n{target.face_normals[t].x, target.face_normals[t].y, target.face_normals[t].z};
        // The direction: along the normal, or at the widest angle at which anything is said, or any.
        const double open = narrow ? std::acos(double(CAP_NARROW_COSINE)) : std::acos(double(CAP_WIDE_COSINE));
        const double widest = std::acos(double(CAP_LEAST_FACING)) - open;
        const double angles[3] = {widest * random.uniform(), widest * random.uniform(0.97, 1.03),
                                  1.5 * random.uniform()};
        const double angle = angles[random.below(3)];
        Vec3 across = cross(n, random.direction());
        across = (1 / std::max(length(across), 1e-9)) * across;
        const Vec3 d = (1 + 1e-4 * random.uniform(-1, 1)) * (std::cos(angle) * n + std::sin(angle) * across);
        // Through the triangle, or a little beside one of its edges, from there or from farther in or out.
        double u = random.uniform(), v = random.uniform();
        if (u + v > 1) u = 1 - u, v = 1 - v;
        const std::size_t first = random.below(3);
        const Vec3 a = corner(first), b = corner((first + 1) % 3), c = corner((first + 2) % 3);
        if (random.below(3) == 0) v = random.uniform(-12, 12) * tolerance / length(c - a);
        if (random.below(6) == 0) u = random.uniform(-2, 3), v = random.uniform(-2, 3);
        const Vec3 through = a + u * (b - a) + v * (c - a);
        double depth = any_length(tolerance, 4 * radius, random);
        if (random.below(4) == 0) depth = random.uniform(0, 12) * tolerance;
        if (random.below(6) == 0) depth = radius * random.uniform(0.99, 1.01) - double(margin);
        if (random.below(2) == 0) depth = -depth;
        const Vec3 from = through - depth * d;
        const double reach = random.below(8) == 0   ? double(UNBOUNDED)
                             : random.below(4) == 0 ? std::fabs(depth) + random.uniform(-3, 3) * tolerance
                                                    : random.uniform(0.001, 1) * target.diagonal;
        const auto ray = prototype_ray(from, d, std::max(reach, 0.0));
        kernels::Held held = kernels::prototype::nothing_held(0);
        held.triangle = slot;
        if (random.below(3) == 0) { // known by a neighbour of a neighbour
            std::uint32_t other = t;
            for (int step = 0; step < 3; ++step) other = target.faces[other].neighbour[random.below(3)];
            held.triangle = target.faces[other].slot;
        }
        ++counts.rays;
        bool stepped = false;
        const auto said = ask(ray, held, target, margin, random.below(RAYS_IN_GROUP), &stepped);
        if (!said) continue;
        const kernels::Hit truth = cast(ray, target);
        ++counts.known;
        counts.contacts += truth.triangle != NONE;
        counts.outside += depth < 0;
        counts.stepped += stepped;
        counts.wrong += differ(*said, truth);
    }
}

void expect(const char* name, const Counts& counts) {
    std::printf("[ counts   ] %s: %llu rays, %llu known, of them %llu contacts, %llu from outside, %llu by another "
                "triangle; %llu wrong\n",
                name, static_cast<unsigned long long>(counts.rays), static_cast<unsigned long long>(counts.known),
                static_cast<unsigned long long>(counts.contacts), static_cast<unsigned long long>(counts.outside),
                static_cast<unsigned long long>(counts.stepped), static_cast<unsigned long long>(counts.wrong));
    EXPECT_EQ(counts.wrong, 0u);
    EXPECT_GT(counts.known, counts.rays / 10);
    EXPECT_GT(counts.contacts, counts.rays / 50);
    EXPECT_GT(counts.outside, counts.rays / 50);
    EXPECT_GT(counts.stepped, counts.rays / 100);
}

TEST(Cap, DecidesAsACastDoes) {
    Random random(12);
    for (const char* kind : {"sphere", "torus", "knot"}) {
        Counts counts;
        const auto shape = Shape::make(scenes::scene_model(kind, 4000).mesh);
        EXPECT_NE(shape->data().header.capped, 0u) << kind;
        examine(*shape, 150000, random, counts);
        expect(kind, counts);
    }
}

// Coarse meshes have few caps, and `certified` does not ask them; what is said is as true.
TEST(Cap, OfCoarseMeshesToo) {
    Random random(13);
    for (const Kind kind : {Kind::concave, Kind::cavities, Kind::slivers}) {
        Counts counts;
        for (const auto& shape : crowd_shapes(kind, 1)) examine(*shape, 60000, random, counts);
        expect(name_of(kind), counts);
    }
}

TEST(Cap, NothingIsSaidWhereTheInsideIsNotKnown) {
    for (const Kind kind : {Kind::open, Kind::crossing})
        for (const auto& shape : crowd_shapes(kind, 1)) {
            if (shape->data().header.outward != 0) continue;
            EXPECT_EQ(shape->data().header.capped, 0u);
            for (const auto& block : shape->data().triangle_blocks)
                EXPECT_TRUE(std::all_of(std::begin(block.cap), std::end(block.cap), [](auto cap) { return cap == 0; }));
        }
}

} // namespace
} // namespace raycontact
