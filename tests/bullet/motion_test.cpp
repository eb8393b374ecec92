// SPDX-License-Identifier: Apache-2.0
// Scenes of tests/motion: bodies slide, coast, roll and bounce as they do on paper. All of them, beside plain Bullet,
// are raycontact-bench motion (docs/internals/bullet-measurements.md).
#include <tests/holds/run.h>
#include <tests/motion/motion.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace raycontact::scenes {
namespace {

const Hold& motion_named(const std::string& name) {
    static const std::vector<Hold> all = all_motions();
    for (const Hold& hold : all)
        if (hold.name == name) return hold;
    throw std::runtime_error("no such scene: " + name);
}

void expect_right(std::initializer_list<const char*> names) {
    for (const char* name : names) {
        const HoldResult result = run_hold(motion_named(name), Finder::edges);
        for (const std::string& failure : result.failures) ADD_FAILURE() << name << ": " << failure;
    }
}

TEST(Motion, ScenesHaveSoundMeshesAndFigures) {
    std::set<std::string> names;
    std::set<std::pair<std::size_t, std::size_t>> seen;
    for (const Hold& hold : all_motions()) {
        EXPECT_TRUE(names.insert(hold.name).second) << hold.name;
        std::set<std::size_t> moving;
        for (const StackBody& body : hold.stack.bodies)
            if (!body.fixed) moving.insert(body.shape);
        EXPECT_FALSE(moving.empty()) << hold.name;
        for (const std::size_t number : moving) {
            const StackShape& shape = hold.stack.shapes[number];
            if (shape.own || !seen.insert({shape.mesh.vertices.size(), shape.mesh.triangles.size()}).second) continue;
            const MeshReport report = prepare_mesh(shape.mesh).report;
            EXPECT_TRUE(report.closed && report.manifold && report.outward && !report.self_intersecting
                        && report.components == 1 && report.repairs.empty())
                << hold.name << ": " << shape.mesh.name;
        }
        const std::vector<Figure> figures = hold.course()->figures();
        EXPECT_TRUE(std::ranges::any_of(figures, [](const Figure& figure) { return !figure.holds(); }))
            << hold.name << " holds before anything moves";
    }
}

TEST(Motion, SlidesWithoutFriction) {
    expect_right({"box slides on closed 1 x 1", "plate of 5 mm slides on closed 1 x 1",
                  "cylinder slides on closed 1 x 1", "hull slides on closed 1 x 1", "ball mesh slides on closed 1 x 1",
                  "capsule mesh slides on closed 1 x 1", "mug slides on closed 1 x 1",
                  "btBoxShape slides on closed 1 x 1", "compound slides on closed 1 x 1", "box slides on plane",
                  "box slides on btBoxShape"});
}

TEST(Motion, BallsAndCapsulesSlideWithoutFriction) {
    expect_right({"btSphereShape slides on closed 1 x 1", "btCapsuleShape slides on closed 1 x 1"});
}

TEST(Motion, FrictionStopsAfterTheRightWay) {
    expect_right({"box with friction 0.3 on closed 1 x 1", "cylinder with friction 0.3 on closed 1 x 1",
                  "hull with friction 0.3 on closed 1 x 1", "mug with friction 0.3 on closed 1 x 1",
                  "box with friction 0.3 on plane"});
}

TEST(Motion, ConveyorsCarry) {
    expect_right({"box on a conveyor, closed 1 x 1", "cylinder on a conveyor, closed 1 x 1",
                  "btBoxShape on a conveyor, closed 100 x 100"});
}

TEST(Motion, BallsKeepTheirEnergyOnSlopes) {
    expect_right({"btSphereShape in an open bowl", "btSphereShape on open waves", "btSphereShape in a closed bowl"});
}

TEST(Motion, StepsHigherThanTheMarginAreWalls) {
    expect_right({"box at a step of 3 mm", "box at a step of 10 mm", "box at a step of 50 mm",
                  "box at two slabs of 1 x 1 cells, 0 mm apart, 3 mm up",
                  "box at two slabs of 1 x 1 cells, 0 mm apart, 150 mm up", "btSphereShape at a step of 150 mm"});
}

TEST(Motion, BouncesBetweenWalls) {
    expect_right({"box between two walls"});
}

// What the figures are worth: they tell what goes wrong.
TEST(Motion, WithoutSpeculativeContactsAStepIsPassed) {
    HoldOptions options;
    options.speculative = false;
    EXPECT_FALSE(run_hold(motion_named("box at a step of 10 mm"), Finder::edges, options).holds());
}

TEST(Motion, EdgesInsideAFloorStopWhatGImpactFinds) {
    EXPECT_FALSE(run_hold(motion_named("box slides on closed 10 x 10"), Finder::gimpact).holds());
}

} // namespace
} // namespace raycontact::scenes
