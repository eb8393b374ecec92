// SPDX-License-Identifier: Apache-2.0
// Accelerators come when they come: no contact of standard or certified depends on it, and a single query makes none.
#include <raycontact/scene.h>

#include "property/shapes.h"
#include "reference/random.h"
#include "reference/vector.h"
#include "scenes/models/model.h"
#include "shape/accelerators.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace raycontact {
namespace {

using namespace reference;

std::shared_ptr<const Shape> new_shape(const char* kind = "knot") {
    return Shape::make(scenes::scene_model(kind, 902).mesh);
}

/// However busy the machine is; a shape that never is prepared hangs the test.
void wait_until_prepared(const Shape& shape) {
    while (!shape.is_prepared()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST(Prepare, BelongsToTheShapeAndIsMadeOnce) {
    const auto shape = new_shape();
    const std::uint64_t before = shape->memory_bytes();
    EXPECT_FALSE(shape->is_prepared());
    shape->prepare();
    EXPECT_TRUE(shape->is_prepared());
    const auto* made = accelerators_of(*shape);
    shape->prepare(2);
    EXPECT_EQ(accelerators_of(*shape), made);
    EXPECT_GT(shape->memory_bytes(), before);
}

TEST(Prepare, ComesAfterASecondMeetingAndNotBefore) {
    for (const Method method : {Method::standard, Method::certified}) {
        const auto a = new_shape(), b = new_shape(), lonely = new_shape();
        Settings settings;
        settings.method = method;
        Scene scene(settings);
        scene.add(a);
        const BodyId moving = scene.add(b, {.translation = {0.3, 0, 0}});
        scene.add(lonely, {.translation = {100, 0, 0}});
        scene.find_contacts();
        scene.find_contacts();
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        EXPECT_FALSE(a->is_prepared() || b->is_prepared()) << "one query, and nothing moved since";
        scene.set_pose(moving, {.translation = {0.301, 0, 0}});
        scene.find_contacts();
        wait_until_prepared(*a);
        wait_until_prepared(*b);
        scene.find_contacts();
        EXPECT_FALSE(lonely->is_prepared());
    }
}

// Its first step had no pair of the step before, and in none since has a pair opened.
TEST(Prepare, ComesToAShapeThatTookThePlaceOfAnother) {
    const auto floor = new_shape(), first = new_shape(), second = new_shape();
    Scene scene;
    const BodyId standing = scene.add(floor), going = scene.add(first, {.translation = {0.3, 0, 0}});
    const BodyId coming = scene.add(second, {.translation = {100, 0, 0}});
    const BodyId of_no_pair = scene.add(second, {.translation = {200, 0, 0}});
    scene.find_contacts();
    scene.set_pose(going, {.translation = {-100, 0, 0}});
    scene.find_contacts();
    scene.set_pose(coming, {.translation = {0.3, 0, 0}});
    scene.find_contacts();
    scene.remove(of_no_pair);
    scene.set_pose(standing, {.translation = {0.001, 0, 0}});
    scene.find_contacts();
    wait_until_prepared(*second);
    wait_until_prepared(*floor);
    EXPECT_FALSE(first->is_prepared()) << "met in one step";
}

TEST(Prepare, MethodsThatFollowRaysDoSoFirst) {
    for (const Method method : {Method::iterative, Method::predictive}) {
        const auto a = new_shape(), b = new_shape();
        Settings settings;
        settings.method = method;
        Scene scene(settings);
        scene.add(a);
        scene.add(b, {.translation = {0.3, 0, 0}});
        scene.find_contacts();
        EXPECT_TRUE(a->is_prepared() && b->is_prepared());
    }
}

TEST(Prepare, OfASceneIsThatOfItsShapes) {
    const auto a = new_shape();
    Scene scene;
    scene.add(a, {.translation = {100, 0, 0}});
    scene.prepare();
    EXPECT_TRUE(a->is_prepared());
}

// Shapes of a moving crowd are prepared in any step, by hand or by the scene beside its steps.
TEST(Prepare, NoContactDependsOnWhen) {
    Random random(7);
    std::uint64_t contacts = 0;
    for (const Method method : {Method::standard, Method::certified})
        for (int run = 0; run < 6; ++run) {
            const char* kinds[] = {"knot", "gear", "torus", "sphere"};
            std::vector<std::shared_ptr<const Shape>> shapes, prepared;
            for (const char* kind : kinds) {
                shapes.push_back(new_shape(kind));
                prepared.push_back(new_shape(kind));
                prepared.back()->prepare();
            }
            Settings settings;
            settings.method = method;
            settings.execution.threads = 2;
            Scene scene(settings), reference(settings);
            std::vector<Pose> poses;
            std::vector<Vec3> ways;
            for (std::size_t i = 0; i < 12; ++i) {
                poses.push_back(random.rotation());
                poses.back().translation = 0.8 * random.in_ball();
                ways.push_back(0.004 * random.in_ball());
                scene.add(shapes[i % 4], poses.back());
                reference.add(prepared[i % 4], poses.back());
            }
            for (std::uint32_t step = 0; step < 40; ++step) {
                if (run < 3 && step == 5u * static_cast<std::uint32_t>(run)) shapes[step % 4]->prepare(1);
                if (run == 3 && step == 20) scene.prepare();
                for (std::uint32_t i = 0; i < 12; ++i) {
                    poses[i].translation = poses[i].translation + ways[i];
                    scene.set_pose({i}, poses[i]);
                    reference.set_pose({i}, poses[i]);
                }
                ASSERT_TRUE(same_bits(scene.find_contacts(), reference.find_contacts())) << "step " << step;
                contacts += scene.contacts().size();
            }
        }
    EXPECT_GT(contacts, 10000u);
}

// The scene goes while its shapes are being prepared.
TEST(Prepare, ASceneThatGoesDoesNotWait) {
    // On a busy machine a shape may be prepared before the scene goes: then another is tried.
    bool waited = true;
    for (std::uint32_t i = 0; i < 5 && waited; ++i) {
        const auto shape = Shape::make(scenes::scene_model("sphere", 60000 + 200 * i).mesh);
        {
            Settings settings;
            settings.features = Features::vertices;
            Scene scene(settings);
            scene.add(shape);
            const double beside = 0.99 * (shape->box_max().x - shape->box_min().x);
            const BodyId moving = scene.add(shape);
            for (int k = 0; k < 3; ++k) {
                scene.set_pose(moving, {.translation = {beside + 1e-4 * k, 0, 0}});
                scene.find_contacts();
            }
        }
        waited = shape->is_prepared();
        shape->prepare();
        EXPECT_TRUE(shape->is_prepared());
    }
    EXPECT_FALSE(waited);
}

} // namespace
} // namespace raycontact
