// SPDX-License-Identifier: Apache-2.0
// Swept clearances around rays: no other triangle is nearer than is said, and a ray moved by less meets what was said.
#include "pairs/rounding.h"
#include "property/crowds.h"
#include "reference/margins.h"
#include "unit/kernels/asked_ray.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

using namespace reference;

// Each triangle alone, so that its distance is the reference's.
std::vector<Solid> apart(const Solid& solid) {
    std::vector<Solid> alone;
    for (const auto& t : solid.triangles)
        alone.push_back(
            make_surface("one", {solid.vertices[t[0]], solid.vertices[t[1]], solid.vertices[t[2]]}, {{0, 1, 2}}));
    return alone;
}

// The distance of a point that runs along a segment from a triangle is convex: sections of it close in on the least.
double distance_to_segment(const Solid& triangle, const Vec3& from, const Vec3& to, double enough) {
    const auto at = [&](double s) { return distance_to_surface(triangle, from + s * (to - from)); };
    if (at(0.5) - 0.5 * length(to - from) > enough) return enough;
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        if (at(a) < at(b))
            high = b;
        else
            low = a;
    }
    return std::min({at(0), at(1), at(low), at(high)});
}

// A vertex a little inside or outside the surface, with a ray that need not be square to it nor quite of unit length.
kernels::prototype::SourceRay any_ray(const ShapeData& target, const Solid& solid, Random& random) {
    const auto& t = solid.triangles[random.below(static_cast<std::uint32_t>(solid.triangles.size()))];
    double u = random.uniform(), v = random.uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3 on = solid.vertices[t[0]] + u * (solid.vertices[t[1]] - solid.vertices[t[0]])
                    + v * (solid.vertices[t[2]] - solid.vertices[t[0]]);
    const double off = std::pow(10.0, random.uniform(-4, -0.5)) * target.diagonal;
    return prototype_ray(on + off * random.in_ball(), (1 + 1e-4 * random.uniform(-1, 1)) * random.direction(),
                         random.uniform(0.001, 0.6) * target.diagonal);
}

struct Counts {
    std::uint64_t rays = 0, clearances = 0, held = 0, contacts = 0, wrong = 0;
    double most_over = -1e300; ///< in margins
    double said = 0, true_ones = 0;
};

// How wide the swept clearance could have been.
void examine_clearance(const kernels::Held& held, const ShapeData& target, const Solid& solid,
                       std::span<const Solid> alone, double radius, double margin, Counts& counts) {
    const Vec3 from = vec(held.position), to = from + double(held.limit) * vec(held.direction);
    double nearest = radius;
    for (std::size_t i = 0; i < alone.size(); ++i) {
        if (held.triangle != NONE
            && target.triangle_blocks[held.triangle / TRIANGLE_LANES].triangle[held.triangle % TRIANGLE_LANES] == i)
            continue;
        if (length(solid.face_normals[i]) < 0.5) continue; // without area: nothing can be met
        nearest = std::min(nearest, distance_to_segment(alone[i], from, to, nearest));
    }
    counts.most_over = std::max(counts.most_over, (double(held.safe) + margin - nearest) / margin);
    counts.said += double(held.safe);
    counts.true_ones += nearest;
}

void examine(const Shape& shape, int rounds, Random& random, Counts& counts) {
    const ShapeData& target = shape.data();
    const Solid solid = make_surface(shape);
    const std::vector<Solid> alone = apart(solid);
    PlacedBody body;
    body.shape = &shape;
    const double margin = rounding_margin(body, body);
    for (int round = 0; round < rounds; ++round) {
        const kernels::prototype::SourceRay ray = any_ray(target, solid, random);
        const auto radius = static_cast<float>(std::pow(10.0, random.uniform(-3, -1)) * target.diagonal);
        const kernels::HeldRange no_cones = held_range(margin, double(radius), false);
        const kernels::Held held = held_after_cast(ray, target, no_cones);
        ++counts.rays;
        if (!(held.safe > 0)) continue;
        ++counts.clearances;
        const Vec3 from = vec(ray.position), to = from + double(held.limit) * vec(ray.direction);
        examine_clearance(held, target, solid, alone, radius, margin, counts);

        // Either end moved by less than the swept clearance's radius, each its own way.
        for (int turn = 0; turn < 3; ++turn) {
            const double far = 0.999 * double(held.safe) * random.uniform();
            const Vec3 start = from + far * random.direction(), end = to + far * random.direction();
            const kernels::prototype::SourceRay moved =
                prototype_ray(start, (1 / double(held.limit)) * (end - start), double(ray.reach));
            const auto said = ask(moved, held, target, no_cones, random.below(RAYS_IN_GROUP));
            if (!said) continue;
            const kernels::Hit truth = cast(moved, target);
            ++counts.held;
            counts.contacts += truth.triangle != NONE;
            counts.wrong += differ(said->hit, truth);
        }
    }
}

TEST(Hold, DecidesAsACastDoes) {
    Random random(8);
    for (const Kind kind : kinds) {
        Counts counts;
        const auto& shapes = crowd_shapes(kind, 1);
        for (const auto& shape : shapes)
            if (shape->triangles().size() < 1000) examine(*shape, 400, random, counts);
        std::printf("[ counts   ] %s: %llu rays, %llu swept clearances, %.3f of their true radius, over it by %.3f "
                    "margins at most; "
                    "%llu moved rays decided, %llu of them contacts, %llu wrong\n",
                    name_of(kind), static_cast<unsigned long long>(counts.rays),
                    static_cast<unsigned long long>(counts.clearances), counts.said / counts.true_ones,
                    counts.most_over, static_cast<unsigned long long>(counts.held),
                    static_cast<unsigned long long>(counts.contacts), static_cast<unsigned long long>(counts.wrong));
        EXPECT_LT(counts.most_over, 0.5);
        EXPECT_EQ(counts.wrong, 0u);
        EXPECT_GT(counts.clearances, counts.rays / 10);
        EXPECT_GT(counts.held, counts.clearances);
        EXPECT_GT(counts.contacts, 50u);
        EXPECT_GT(counts.said, 0.5 * counts.true_ones);
    }
}

} // namespace
} // namespace raycontact
