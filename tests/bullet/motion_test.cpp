// SPDX-License-Identifier: Apache-2.0
// Scenes of tests/motion: bodies slide, coast, roll and bounce as they do on paper. All of them, beside plain Bullet,
// are raycontact-bench motion (docs/internals/bullet-measurements.md, which says what does not hold).
#include <tests/holds/run.h>
#include <tests/motion/motion.h>
#include <tests/motion/polygon.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <numbers>
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
    expect_right({"box slides on closed 1 x 1", "box slides on closed 100 x 100", "box slides on open 100 x 100",
                  "box slides on closed 10 x 10", "box slides on closed 1 x 400", "box slides on open 1 x 400",
                  "box slides on uneven 100 x 100", "box slides on height field", "box slides on plane",
                  "box slides on btBoxShape", "cylinder slides on closed 1 x 1", "cylinder slides on closed 100 x 100",
                  "cylinder slides on open 100 x 100", "cylinder slides on closed 1 x 100"});
}

TEST(Motion, BodiesOfAllKindsSlide) {
    expect_right({"plate of 5 mm slides on closed 100 x 100", "plate of 5 mm slides on open 100 x 100",
                  "hull slides on closed 100 x 100", "hull slides on open 100 x 100",
                  "ball mesh slides on closed 100 x 100", "capsule mesh slides on closed 100 x 100",
                  "pebble slides on closed 100 x 100", "mug slides on closed 100 x 100", "mug slides on open 100 x 100",
                  "compound slides on closed 100 x 100", "compound of meshes slides on closed 100 x 100",
                  "compound of meshes slides on open 100 x 100"});
}

TEST(Motion, ShapesOfBulletsOwnSlide) {
    expect_right({"btBoxShape slides on closed 100 x 100", "btCylinderShape slides on closed 100 x 100",
                  "btConvexHullShape slides on closed 100 x 100", "btSphereShape slides on closed 1 x 1",
                  "btSphereShape slides on closed 100 x 100", "btSphereShape slides on open 100 x 100",
                  "btCapsuleShape slides on closed 1 x 1", "btCapsuleShape slides on closed 100 x 100",
                  "btCapsuleShape slides on open 100 x 100"});
}

TEST(Motion, ShapesOfBulletsOwnSlideOnOpenMeshes) {
    expect_right({"btBoxShape slides on open 100 x 100", "btCylinderShape slides on open 100 x 100",
                  "btConvexHullShape slides on open 100 x 100", "compound slides on open 100 x 100",
                  "btBoxShape crosses T-junctions 96 to 48", "btBoxShape on open waves"});
}

TEST(Motion, FrictionStopsAfterTheRightWay) {
    expect_right({"box with friction 0.3 on closed 1 x 1", "box with friction 0.3 on closed 100 x 100",
                  "box with friction 0.3 on open 100 x 100", "box with friction 0.3 on uneven 100 x 100",
                  "box with friction 0.3 on plane", "cylinder with friction 0.3 on closed 100 x 100",
                  "hull with friction 0.3 on closed 100 x 100", "mug with friction 0.3 on closed 1 x 1",
                  "mug with friction 0.3 on closed 100 x 100", "btBoxShape with friction 0.3 on closed 100 x 100",
                  "compound with friction 0.3 on closed 100 x 100"});
}

TEST(Motion, ConveyorsCarry) {
    expect_right({"box on a conveyor, closed 1 x 1", "box on a conveyor, closed 100 x 100",
                  "cylinder on a conveyor, closed 1 x 1", "btBoxShape on a conveyor, closed 100 x 100"});
}

TEST(Motion, SeamsOfOneMeshAreNotFelt) {
    expect_right({"box crosses T-junctions 96 to 48", "box crosses T-junctions 96 to 90",
                  "box crosses T-junctions 1 to 96", "box crosses T-junctions 300 to 7",
                  "cylinder crosses T-junctions 96 to 48", "btSphereShape crosses T-junctions 96 to 48",
                  "btSphereShape crosses T-junctions 300 to 7", "btCapsuleShape crosses T-junctions 96 to 48"});
}

TEST(Motion, SeamsOfTwoBodiesAreNotFelt) {
    expect_right({"box crosses two slabs of 1 x 1 cells, 0 mm apart, 0 mm up",
                  "box crosses two slabs of 1 x 1 cells, 0.1 mm apart, 0 mm up",
                  "box crosses two slabs of 1 x 1 cells, 0 mm apart, 0.1 mm up",
                  "box crosses two slabs of 48 x 48 cells, 0 mm apart, 0 mm up",
                  "cylinder crosses two slabs of 1 x 1 cells, 0 mm apart, 0 mm up",
                  "btSphereShape crosses two slabs of 1 x 1 cells, 0 mm apart, 0 mm up",
                  "btSphereShape crosses two slabs of 1 x 1 cells, 0 mm apart, 0.1 mm up",
                  "btCapsuleShape crosses two slabs of 1 x 1 cells, 0 mm apart, 0 mm up",
                  "box crosses 144 cubes, 0 mm up by turns", "box crosses 144 cubes, 0.1 mm up by turns",
                  "cylinder crosses 144 cubes, 0 mm up by turns", "btSphereShape crosses 144 cubes, 0 mm up by turns"});
}

TEST(Motion, EnergyIsKeptOnSlopes) {
    expect_right({"btSphereShape in an open bowl", "btSphereShape on open waves", "btSphereShape in a closed bowl",
                  "box on open waves", "box on closed waves", "btBoxShape on closed waves"});
}

TEST(Motion, WheelsRoll) {
    expect_right({"wheel on a floor of one cell, 64 sides, 1 m/s", "wheel on a floor of one cell, 64 sides, 5 m/s",
                  "wheel on a floor of one cell, 64 sides, 20 m/s",
                  "wheel on a floor of 192 x 16 cells, 32 sides, 5 m/s",
                  "wheel on a floor of 192 x 16 cells, 128 sides, 1 m/s",
                  "wheel on a floor of 192 x 16 cells, 128 sides, 20 m/s", "wheelset on rails, 128 sides, 5 m/s",
                  "wheelset on rails of 1 m, 32 sides, 5 m/s", "wheelset on rails of 1 m, 128 sides, 1 m/s"});
}

// What the steps alone take goes with them; what the corners take stays (McGeer 1990).
TEST(Motion, APolygonLosesWhatItsCornersExplain) {
    for (const int sides : {32, 64}) {
        const Polygon wheel{sides, 0.4, 0.08, 0.5};
        const double corner = std::numbers::pi / sides, side = 0.8 * std::sin(corner), arm = 0.16;
        const double kept = (wheel.inertia + arm * std::cos(2 * corner)) / (wheel.inertia + arm);
        const double on_paper = std::pow(kept, std::floor(3 / side)); // at least: it slows down, and meets fewer
        const double coarse = wheel.keeps(1, 3, 60), finer = wheel.keeps(1, 3, 240), fine = wheel.keeps(1, 3, 8000);
        std::printf(
            "[ counts ] %d sides keep %.3f of 1 m/s after 3 s at 60 steps a second, %.3f at 240, %.3f at 8 000; "
            "corners explain %.3f\n",
            sides, coarse, finer, fine, on_paper);
        EXPECT_LT(coarse, 0.8 * fine) << sides;
        EXPECT_NEAR(fine, on_paper, 0.08) << sides;
    }
}

TEST(Motion, StepsHigherThanTheMarginAreWalls) {
    expect_right({"box at a step of 3 mm", "box at a step of 10 mm", "box at a step of 50 mm",
                  "box at a step of 150 mm", "box at two slabs of 1 x 1 cells, 0 mm apart, 3 mm up",
                  "box at two slabs of 1 x 1 cells, 0 mm apart, 150 mm up", "cylinder at a step of 150 mm",
                  "btBoxShape at a step of 150 mm", "btSphereShape at a step of 150 mm"});
}

TEST(Motion, BouncesBetweenWalls) {
    expect_right({"box between two walls"});
}

TEST(Motion, BallsBounceBetweenWalls) {
    expect_right({"btSphereShape between two walls"});
}

TEST(Motion, BodiesBounce) {
    expect_right({"box falls by 1 m on closed 1 x 1, restitution 0.5",
                  "box falls by 1 m on closed 100 x 100, restitution 0.5",
                  "box falls by 1 m on open 100 x 100, restitution 0.8",
                  "cylinder falls by 1 m on closed 100 x 100, restitution 0.5",
                  "pebble falls by 1 m on closed 1 x 1, restitution 0.5",
                  "btBoxShape falls by 1 m on closed 100 x 100, restitution 0.5"});
}

TEST(Motion, BallsAndCapsulesBounce) {
    expect_right({"btSphereShape falls by 1 m on closed 1 x 1, restitution 0.5",
                  "btSphereShape falls by 1 m on open 100 x 100, restitution 0.8",
                  "btCapsuleShape falls by 1 m on closed 100 x 100, restitution 0.5"});
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
