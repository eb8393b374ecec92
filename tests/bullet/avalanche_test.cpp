// SPDX-License-Identifier: Apache-2.0
#include <scenes/avalanche.h>

#include <raycontact/error.h>
#include <scenes/simulation.h>

#include <gtest/gtest.h>

namespace raycontact::scenes {
namespace {

SceneOptions small() {
    SceneOptions o;
    o.bodies = 27;
    o.model = "torus"; // procedural: no package needed
    o.triangles = 300;
    o.steps = 60;
    return o;
}

std::string hash_of(const SceneOptions& o, std::uint32_t steps, std::uint64_t* contacts = nullptr) {
    Simulation scene(avalanche(o));
    for (std::uint32_t i = 0; i < steps; ++i) {
        scene.step();
        if (contacts) *contacts += scene.stats().contacts;
    }
    return scene.hash();
}

TEST(Avalanche, SameSeedSameHash) {
    SceneOptions o = small();
    std::uint64_t contacts = 0;
    o.settings.execution.threads = 1;
    const std::string hash = hash_of(o, 60, &contacts);
    EXPECT_GT(contacts, 400u);
    EXPECT_EQ(hash_of(o, 60), hash);
    o.settings.execution.threads = 2;
    EXPECT_EQ(hash_of(o, 60), hash);
    o.settings.execution.threads = 5;
    EXPECT_EQ(hash_of(o, 60), hash);
    o.settings.paper.caster = Caster::basic;
    EXPECT_EQ(hash_of(o, 60), hash);
    o.seed = 2;
    EXPECT_NE(hash_of(o, 60), hash);
}

TEST(Avalanche, OneBodyComesToRest) {
    SceneOptions o = small();
    o.bodies = 1;
    Simulation scene(avalanche(o));
    for (int i = 0; i < 420; ++i) scene.step();
    const Health h = scene.health();
    EXPECT_LT(h.median_speed_last_second, 0.05);
    EXPECT_EQ(h.below_ground, 0u);
    EXPECT_EQ(h.flown_off, 0u);
    EXPECT_EQ(h.deep_steps_last_second, 0u);
    EXPECT_FALSE(scene.contacts().empty());
    for (const Contact& c : scene.contacts()) {
        EXPECT_EQ(c.body_a, BodyId{0});
        EXPECT_EQ(c.body_b, BodyId{1}); // the ground is the last
    }
}

TEST(Avalanche, PileComesToRest) {
    SceneOptions o = small();
    o.steps = 480;
    Simulation scene(avalanche(o));
    for (int i = 0; i < 480; ++i) scene.step();
    const Health h = scene.health();
    EXPECT_LT(h.median_speed_last_second, 0.05);
    EXPECT_LE(h.deep_steps_last_second, 6u); // a tenth of a second
    EXPECT_EQ(h.below_ground, 0u);
    EXPECT_EQ(h.flown_off, 0u);
}

TEST(Avalanche, LogHoldsWhatAReportNeeds) {
    SceneOptions o = small();
    o.bodies = 10; // not a cube
    Simulation scene(avalanche(o));
    EXPECT_EQ(scene.body_count(), 10u);
    for (int i = 0; i < 60; ++i) scene.step();
    const RunLog& log = scene.log();
    EXPECT_EQ(log.rows.size(), 60u);
    ASSERT_EQ(log.frames.size(), 8u);
    EXPECT_EQ(log.frames.front().step, 0u);
    EXPECT_EQ(log.frames.back().step, 59u);
    ASSERT_EQ(log.body_moves.size(), 11u);
    EXPECT_TRUE(log.body_moves.front());
    EXPECT_FALSE(log.body_moves.back());
    EXPECT_EQ(log.frames[3].poses.size(), 11u);
    EXPECT_EQ(log.shapes.size(), 2u);
    EXPECT_FALSE(log.mesh_source.empty());
    EXPECT_EQ(log.rows.back().contacts, scene.stats().contacts);
}

TEST(Avalanche, RefusesAModelThatIsNotKnown) {
    SceneOptions o = small();
    o.model = "teapot";
    EXPECT_THROW(avalanche(o), InputError);
}

} // namespace
} // namespace raycontact::scenes
