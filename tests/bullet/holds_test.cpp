// SPDX-License-Identifier: Apache-2.0
// Scenes of tests/holds, shortened: nothing passes through anything, and what rests is slow. The whole runs are
// raycontact-bench holds (docs/internals/bullet-measurements.md).
#include <tests/holds/depth.h>
#include <tests/holds/run.h>

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace raycontact::scenes {
namespace {

Hold hold_named(const std::string& name) {
    for (Hold& hold : all_holds())
        if (hold.name == name) return hold;
    throw std::runtime_error("no such scene: " + name);
}

std::string words(const HoldResult& result) {
    std::string all;
    for (const std::string& failure : result.failures) all += failure + "; ";
    return all;
}

TEST(Holds, ScenesBeginApartWithSoundMeshes) {
    std::set<std::string> names;
    for (const Hold& hold : all_holds()) {
        EXPECT_TRUE(names.insert(hold.name).second) << hold.name;
        if (hold.name.starts_with("nut") && !hold.name.ends_with(" 60 Hz")) continue; // the same bodies
        for (const StackShape& shape : hold.stack.shapes) {
            const MeshReport report = prepare_mesh(shape.mesh).report;
            EXPECT_TRUE(report.closed && report.manifold && report.outward && !report.self_intersecting
                        && report.components == 1 && report.repairs.empty())
                << hold.name << ": " << shape.mesh.name;
        }
        // Neighbours of a wall and stones of an arch touch, to rounding.
        std::vector<Pose> poses;
        for (const StackBody& body : hold.stack.bodies) poses.push_back(body.pose);
        EXPECT_LT(DepthProbe(hold.stack, hold.ground).deepest(poses), 1e-6 * hold.size) << hold.name;
    }
}

struct Short {
    const char* name;
    double seconds;
    int iterations = 0;
};

class HoldsOf : public testing::TestWithParam<Short> {};

TEST_P(HoldsOf, Ours) {
    const Short& what = GetParam();
    HoldOptions options;
    options.seconds = what.seconds;
    options.iterations = what.iterations;
    const HoldResult result = run_hold(hold_named(what.name), Finder::edges, options);
    EXPECT_TRUE(result.holds()) << words(result);
    EXPECT_EQ(result.passed, 0);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, HoldsOf,
    testing::Values(Short{"wall", 3, 100}, Short{"arch", 4, 500}, Short{"heavy cube on light", 4, 500},
                    Short{"heavy torus on light", 4, 500}, Short{"column of tori", 2, 500},
                    Short{"hand presses a bunny, 60 Hz", 5}, Short{"hand presses a cube, 60 Hz", 5},
                    Short{"hand presses a bunny, 90 Hz", 5}, Short{"hand presses a cube, 90 Hz", 5},
                    Short{"ball, a mesh, 100 m/s, foil of 1 mm", 1}, Short{"chain of 5 links", 25},
                    Short{"chain of 10 links", 30}, Short{"chain of 20 links", 40},
                    Short{"gears of 20 and 30 teeth", 3}, Short{"mug on a hook", 20},
                    Short{"peg in a hole with 0.1 mm of play", 5}, Short{"nut M20, friction 0.05, 60 Hz", 1.5}));

// What the numbers are worth: the same scenes fail where nothing is seen before it touches.
TEST(Holds, WithoutSpeculativeContactsAFoilIsPassed) {
    HoldOptions options;
    options.speculative = false;
    EXPECT_GT(run_hold(hold_named("ball, a mesh, 100 m/s, foil of 1 mm"), Finder::edges, options).passed, 0);
}

} // namespace
} // namespace raycontact::scenes
