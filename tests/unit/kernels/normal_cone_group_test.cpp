// SPDX-License-Identifier: Apache-2.0
// Of each ray of a group the same is said as of that ray alone, whatever the others are: held by a swept clearance,
// asked of normal-cone balls or not, of other meshes, or without a triangle. On a GPU a group is one ray.
#include "pairs/rounding.h"
#include "property/crowds.h"
#include "scenes/models/model.h"
#include "unit/kernels/aimed_ray.h"
#include "unit/shape/accelerated.h"

#include <cstdio>
#include <deque>
#include <gtest/gtest.h>
#include <vector>

namespace raycontact {
namespace {

using namespace reference;

struct Ground {
    explicit Ground(const std::vector<std::shared_ptr<const Shape>>& all) : shapes(all) {
        for (const auto& shape : all) of_shapes.push_back(accelerated(*shape));
    }

    std::vector<std::shared_ptr<const Shape>> shapes;
    std::deque<ShapeData> of_shapes;
};

struct Asked {
    kernels::prototype::SourceRay ray{};
    kernels::Held held{};
    kernels::HeldRange held_range{};
    std::uint32_t target = 0;
};

Asked any_ray(const Ground& ground, Random& random) {
    Asked asked;
    std::optional<AimedRay> aimed;
    double margin = 0;
    while (!aimed) { // some of the coarse meshes have few normal-cone balls, or none
        asked.target = random.below(static_cast<std::uint32_t>(ground.shapes.size()));
        PlacedBody body;
        body.shape = ground.shapes[asked.target].get();
        margin = rounding_margin(body, body);
        aimed = aim_at_cone(ground.of_shapes[asked.target], margin, random);
    }
    const ShapeData& target = ground.of_shapes[asked.target];
    asked.held_range = held_range(margin, any_length(1e-3, 1e-1, random) * target.diagonal, random.below(4) > 0);
    asked.ray = aimed->ray;
    if (random.below(3) == 0) {
        asked.held = held_after_cast(asked.ray, target, asked.held_range);
        for (float& p : asked.ray.position) p += static_cast<float>(0.7 * random.uniform(-1, 1)) * asked.held.safe;
    } else {
        asked.held = known_triangle(target, aimed->triangle_lane, random);
    }
    if (random.below(10) == 0) asked.held.triangle = NONE;
    return asked;
}

TEST(CapGroup, SaysOfEachRayWhatItSaysOfThatAlone) {
    std::vector<std::shared_ptr<const Shape>> shapes = crowd_shapes(Kind::concave, 1);
    for (const char* kind : {"sphere", "knot"}) shapes.push_back(Shape::make(scenes::scene_model(kind, 4000).mesh));
    const Ground ground(shapes);
    const kernels::prototype::RayArrays arrays{};
    Random random(14);
    kernels::prototype::HeldGroup group{};
    std::uint64_t rays = 0, by_clearance = 0, by_cone = 0, stepped = 0, differing = 0;
    for (int round = 0; round < 10000; ++round) {
        const std::uint32_t count = 1 + random.below(RAYS_IN_GROUP);
        std::vector<Asked> all;
        for (std::uint32_t i = 0; i < count; ++i) {
            const Asked& asked = all.emplace_back(any_ray(ground, random));
            add_held(&arrays, &group, i, &asked.ray, &asked.held, &asked.held_range, 0,
                     &ground.of_shapes[asked.target].header);
        }
        fetch_triangles(&arrays, &group);
        test_clearances_and_cones(&arrays, &group);
        for (std::uint32_t i = 0; i < count; ++i) {
            const auto together = said_of(arrays, group, i);
            const auto alone = ask(all[i].ray, all[i].held, ground.of_shapes[all[i].target], all[i].held_range, 0);
            ++rays;
            if (together.has_value() != alone.has_value()) {
                ++differing;
            } else if (alone) {
                differing += differ(together->hit, alone->hit) || together->triangle_lane != alone->triangle_lane;
                ++(all[i].held.safe > 0 && alone->triangle_lane == all[i].held.triangle ? by_clearance : by_cone);
                stepped += alone->triangle_lane != all[i].held.triangle;
            }
        }
        group.rays.count = 0;
    }
    std::printf("[ counts   ] %llu rays, %llu known with a swept clearance, %llu by normal-cone balls, %llu of them by "
                "another triangle; %llu "
                "differ\n",
                static_cast<unsigned long long>(rays), static_cast<unsigned long long>(by_clearance),
                static_cast<unsigned long long>(by_cone), static_cast<unsigned long long>(stepped),
                static_cast<unsigned long long>(differing));
    EXPECT_EQ(differing, 0u);
    EXPECT_GT(by_clearance, rays / 50);
    EXPECT_GT(by_cone, rays / 10);
    EXPECT_GT(stepped, rays / 200);
}

} // namespace
} // namespace raycontact
