// SPDX-License-Identifier: Apache-2.0
// Held rays asked sixteen at a time say what the ray test says of each alone, bit for bit: in groups of every kind of
// ray, filled again and again, and whatever the floats.
#include "reference/random.h"
#include "shape/shape_data.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

namespace raycontact {
namespace {

using namespace kernels::prototype;
using reference::Random;

constexpr std::uint32_t blocks_of_shape = 3;

struct Ground {
    std::vector<kernels::ShapeHeader> shapes;
    std::vector<kernels::TriangleBlock> blocks;
    std::vector<kernels::Packed3> normals;
};

enum class Floats : std::uint8_t { ordinary, on_a_grid, odd };

float any_float(Floats kind, Random& random) {
    constexpr float inf = std::numeric_limits<float>::infinity();
    constexpr float odd[] = {0.0F,    -0.0F,   1.0e-45F, 1.0e-20F, -1.0e-20F,
                             3.0e38F, 1.0e19F, inf,      -inf,     std::numeric_limits<float>::quiet_NaN(),
                             1.0F,    -1.0F,   0.5F,     -3.0e38F, 2.0e-38F};
    if (kind == Floats::on_a_grid) return static_cast<float>(random.below(5)) - 2;
    if (kind == Floats::odd && random.below(6) == 0) return odd[random.below(std::size(odd))];
    return static_cast<float>(random.uniform(-1, 1));
}

Ground any_ground(Floats kind, Random& random) {
    Ground ground;
    ground.blocks.reserve(std::size_t{3} * blocks_of_shape);
    ground.normals.reserve(std::size_t{3} * blocks_of_shape * TRIANGLE_LANES);
    for (std::uint32_t s = 0; s < 3; ++s) {
        kernels::ShapeHeader shape{};
        shape.triangle_blocks =
            host_place(ground.blocks) + sizeof(kernels::TriangleBlock) / sizeof(kernels::ulong) * blocks_of_shape * s;
        shape.face_normals = host_place(ground.normals)
                             + sizeof(kernels::Packed3) * TRIANGLE_LANES / sizeof(kernels::ulong) * blocks_of_shape * s;
        shape.closed = random.below(2);
        shape.tolerance = static_cast<float>(std::pow(10.0, random.uniform(-7, -4)));
        ground.shapes.push_back(shape);
        for (std::uint32_t b = 0; b < blocks_of_shape; ++b) {
            kernels::TriangleBlock& block = ground.blocks.emplace_back();
            for (std::uint32_t lane = 0; lane < TRIANGLE_LANES; ++lane) {
                block.triangle[lane] = random.below(blocks_of_shape * TRIANGLE_LANES);
                for (auto& row : block.corner) row[lane] = any_float(kind, random);
            }
        }
    }
    for (std::uint32_t i = 0; i < 3 * blocks_of_shape * TRIANGLE_LANES; ++i) {
        const auto n = random.direction();
        ground.normals.push_back({static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)});
    }
    return ground;
}

struct Asked {
    SourceRay ray{};
    kernels::Held held{};
    std::uint32_t target = 0;
};

Asked any_ray(Floats kind, const Ground& ground, Random& random) {
    Asked asked;
    asked.target = random.below(3);
    kernels::Held& held = asked.held;
    held.triangle = random.below(6) == 0 ? NONE : random.below(blocks_of_shape * TRIANGLE_LANES);
    float aim[3]{};
    if (held.triangle != NONE) {
        const auto& block = ground.blocks[blocks_of_shape * asked.target + held.triangle / TRIANGLE_LANES];
        double u = random.uniform(), v = random.uniform();
        if (u + v > 1) u = 1 - u, v = 1 - v;
        if (random.below(4) == 0) v = 0; // an edge
        if (random.below(8) == 0) u = 0;
        for (std::uint32_t i = 0; i < 3; ++i)
            aim[i] = static_cast<float>((1 - u - v) * double(block.corner[i][held.triangle % TRIANGLE_LANES])
                                        + u * double(block.corner[3 + i][held.triangle % TRIANGLE_LANES])
                                        + v * double(block.corner[6 + i][held.triangle % TRIANGLE_LANES]));
    }
    const auto d = random.direction();
    const double off = random.below(4) == 0 ? 0 : random.uniform(-0.2, 1);
    const double components[3] = {d.x, d.y, d.z};
    for (std::uint32_t i = 0; i < 3; ++i) {
        asked.ray.direction[i] = kind == Floats::ordinary ? static_cast<float>(components[i]) : any_float(kind, random);
        asked.ray.position[i] = kind == Floats::on_a_grid ? any_float(kind, random)
                                                          : aim[i] - static_cast<float>(off) * asked.ray.direction[i];
        held.position[i] = asked.ray.position[i] + static_cast<float>(0.01 * random.uniform(-1, 1));
        held.direction[i] = asked.ray.direction[i] + static_cast<float>(0.01 * random.uniform(-1, 1));
    }
    asked.ray.reach = random.below(8) == 0 ? UNBOUNDED : static_cast<float>(1.5 * random.uniform());
    held.limit = random.below(3) == 0 && asked.ray.reach < UNBOUNDED ? asked.ray.reach
                                                                     : static_cast<float>(1.5 * random.uniform());
    held.safe = random.below(8) == 0 ? 1.0e3F : static_cast<float>(0.1 * random.uniform());
    return asked;
}

struct Counts {
    std::uint64_t rays = 0, known = 0, hits = 0, wrong = 0, wrongly_known = 0;
};

// What the ray test says of the one triangle, and whether the held ray may and must be known by it.
void compare(const Asked& asked, const HeldGroup& group, std::uint32_t lane, const Ground& ground, Counts& counts) {
    const kernels::ShapeHeader& shape = ground.shapes[asked.target];
    const kernels::Held& held = asked.held;
    Closest closest = nothing_hit(asked.ray.reach, shape.tolerance);
    const RayFrame frame = frame_ray(asked.ray.position, asked.ray.direction, false);
    if (held.triangle != NONE)
        hit_lane(&closest, &frame, &ground.blocks[blocks_of_shape * asked.target + held.triangle / TRIANGLE_LANES],
                 held.triangle % TRIANGLE_LANES, shape.tolerance, false);
    double start = 0, end = 0;
    for (std::uint32_t i = 0; i < 3; ++i) {
        const double shift = double(asked.ray.position[i]) - double(held.position[i]);
        const double turned = double(asked.ray.direction[i]) - double(held.direction[i]);
        start += shift * shift;
        end += (shift + double(held.limit) * turned) * (shift + double(held.limit) * turned);
    }
    const double moved = std::sqrt(start > end ? start : end);
    ++counts.rays;
    const float met = closest.back < closest.front ? closest.back : closest.front;
    const bool decides = met + LIMIT_TOLERANCES * shape.tolerance <= held.limit || held.limit >= asked.ray.reach;
    const bool known = group.is_known[lane] != 0;
    if (known && !(moved < 1.0001 * double(held.safe))) ++counts.wrongly_known;
    if (known && !decides) ++counts.wrongly_known;
    if (!known && decides && moved < 0.9999 * double(held.safe)) ++counts.wrongly_known;
    if (!known) return;
    ++counts.known;
    // Of one triangle there is nothing to tell apart: decide() casts no other ray, and needs no tree.
    const RayArrays arrays{};
    const kernels::Hit truth = decide(&arrays, CASTER_BVH, &asked.ray, &closest, &shape);
    const kernels::Hit said = held_hit(&arrays, &group, lane);
    counts.hits += truth.triangle != NONE;
    const auto same = [](float a, float b) {
        return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) || (std::isnan(a) && std::isnan(b));
    };
    counts.wrong += said.triangle != truth.triangle || !same(said.distance, truth.distance)
                    || !same(said.facing, truth.facing) || said.sides != truth.sides;
}

TEST(HeldGroup, SaysOfEachRayWhatTheRayTestSays) {
    Random random(16);
    const kernels::HeldRange no_cones{};
    for (const Floats kind : {Floats::ordinary, Floats::on_a_grid, Floats::odd}) {
        Counts counts;
        HeldGroup group{};
        for (int round = 0; round < 12000; ++round) {
            const Ground ground = any_ground(kind, random);
            const RayArrays arrays{};
            for (int again = 0; again < 4; ++again) {
                const std::uint32_t count = 1 + random.below(RAYS_IN_GROUP);
                std::vector<Asked> all;
                for (std::uint32_t i = 0; i < count; ++i) {
                    const Asked& asked = all.emplace_back(any_ray(kind, ground, random));
                    add_held(&arrays, &group, i, &asked.ray, &asked.held, &no_cones, 0, &ground.shapes[asked.target]);
                }
                fetch_triangles(&arrays, &group);
                test_held(&group);
                for (std::uint32_t i = 0; i < count; ++i) compare(all[i], group, i, ground, counts);
                group.rays.count = 0;
            }
        }
        std::printf("[ counts   ] %llu rays, %llu known, %llu hits, %llu wrong\n",
                    static_cast<unsigned long long>(counts.rays), static_cast<unsigned long long>(counts.known),
                    static_cast<unsigned long long>(counts.hits), static_cast<unsigned long long>(counts.wrong));
        EXPECT_EQ(counts.wrong, 0U);
        EXPECT_EQ(counts.wrongly_known, 0U);
        EXPECT_GT(counts.known, counts.rays / 10);
        EXPECT_GT(counts.hits, 1000U);
    }
}

} // namespace
} // namespace raycontact
