// SPDX-License-Identifier: Apache-2.0
#include "reference/meshes.h"

#include <raycontact/scene.h>
#include <view/view.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace raycontact::view {
namespace {

/// A box sinks into another, 1 mm a step; a third comes in step 50, far off.
struct Sinking {
    explicit Sinking(std::uint32_t steps) {
        const auto box = Shape::make(reference::box_mesh({0.5, 0.5, 0.5}));
        log.scene = "sinking";
        log.shapes = {box};
        Scene scene{Settings{}};
        const auto add = [&](const Vec3& at) {
            log.body_shape.push_back(0);
            log.body_moves.push_back(!log.body_moves.empty());
            return scene.add(box, Pose{.translation = at});
        };
        const BodyId below = add({0, 0, 0}), above = add({0.2, 0.1, 1});
        for (std::uint32_t i = 0; i < steps; ++i) {
            if (i == 50) add({9, 0, 0});
            scene.set_pose(above, Pose{.translation = {0.2, 0.1, height(i)}});
            scene.find_contacts(std::vector<Pair>{{below, above}});
            log.rows.emplace_back().step = i;
            run.add(scene);
        }
    }
    static double height(std::uint32_t step) { return 0.999 - 0.001 * step; }
    scenes::RunLog log;
    RunView run;
};

TEST(RunView, KeepsEveryStepOfAShortRun) {
    const Sinking sinking(60);
    EXPECT_EQ(sinking.run.steps(), 60u);
    EXPECT_EQ(sinking.run.first_steps(), (std::vector<std::uint32_t>{0, 0, 50}));
    ASSERT_EQ(sinking.run.found().layers.size(), 60u);
    const Motion motion = sinking.run.motion(sinking.log.body_moves);
    EXPECT_EQ(motion.kept, 60u);
    EXPECT_EQ(motion.stride, 1u);
    EXPECT_EQ(motion.moves, sinking.log.body_moves);
    for (std::uint32_t i = 0; i < 60; ++i) {
        const double part = motion.numbers[(numbers_a_pose + 2) * 60 + i] / 65535.0;
        EXPECT_NEAR(motion.low[2] + part * (motion.high[2] - motion.low[2]), Sinking::height(i), 1e-4);
        EXPECT_EQ(motion.numbers[2 * numbers_a_pose * 60 + i], 65535); // x of the third, also before it comes
        EXPECT_EQ(sinking.run.found().layers[i].contacts.size(), sinking.run.found().contacts[i]);
    }
}

TEST(RunView, KeepsFewerStepsOfALongOneEvenly) {
    const Sinking sinking(300);
    const Found& found = sinking.run.found();
    EXPECT_EQ(found.contacts.size(), 300u);
    ASSERT_EQ(found.layers.size(), 38u);
    for (std::uint32_t k = 0; k < 38; ++k) EXPECT_EQ(found.layers[k].step, 8 * k);
}

TEST(RunView, KeepsFewerPosesOfALongOneEvenly) {
    Scene scene{Settings{}};
    const auto box = Shape::make(reference::box_mesh({0.5, 0.5, 0.5}));
    for (int i = 0; i < 1000; ++i) scene.add(box, Pose{.translation = {2.0 * i, 0, 0}});
    RunView run;
    for (int i = 0; i < 301; ++i) {
        scene.find_contacts(std::vector<Pair>{});
        run.add(scene);
    }
    const Motion motion = run.motion(std::vector<bool>(1000, true));
    EXPECT_EQ(motion.stride, 2u);
    EXPECT_EQ(motion.kept, 151u); // the first step, and the last, which is even
    EXPECT_EQ(motion.bodies, 1000u);
}

TEST(RunView, IsAPage) {
    const Sinking sinking(60);
    const View view = make_view(sinking.log, sinking.run, Settings{});
    const std::string start = "id=\"recording\">";
    const std::size_t from = view.html.find(start) + start.size();
    const auto data = nlohmann::json::parse(view.html.substr(from, view.html.find("</script>", from) - from));
    EXPECT_EQ(data["scene"], "sinking");
    EXPECT_EQ(data["steps"], 60);
    EXPECT_EQ(data["standing"], 1);
    EXPECT_EQ(data["motion"]["kept"], 60);
    EXPECT_EQ(data["bodies"][2][1], 50); // comes
    EXPECT_EQ(data["bodies"][2][2], 60); // and stays
    EXPECT_EQ(data["layers"]["contacts"].size(), 60u);
    EXPECT_GT(view.contacts, 0u);
    EXPECT_EQ(view.html.find("http"), std::string::npos);
}

} // namespace
} // namespace raycontact::view
