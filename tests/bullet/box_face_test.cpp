// SPDX-License-Identifier: Apache-2.0
// A mesh over one face of a box: what it costs less for must be what the batch would have found.
#include "test_world.h"

#include <objects.h>
#include <plane.h>
#include <scenes/random.h>
#include <stand_in.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

namespace raycontact::test {
namespace {

using Depths = std::map<std::uint32_t, double>; ///< by vertex

TEST(BoxFace, FindsWhatTheBatchFinds) {
    const btBoxShape box(btVector3(2, btScalar(1.5), 1));
    const auto slab = Shape::make(bullet::stand_in(box));
    scenes::Random random(4);
    int over = 0, found_of_all = 0;
    for (const auto& shape : {table(), torus()}) {
        const bullet::Converted mesh{shape, std::make_shared<bullet::BulletMesh>(shape)};
        for (int i = 0; i < 1500; ++i) {
            const auto number = [&](double size) { return btScalar(size * random.symmetric()); };
            const auto turn = [&] {
                const auto r = random.rotation();
                return btQuaternion(btScalar(r[1]), btScalar(r[2]), btScalar(r[3]), btScalar(r[0]));
            };
            const btTransform box_pose(turn(), btVector3(number(3), number(3), number(3)));
            // Somewhere at the box's surface, mostly.
            const btTransform relative(turn(), btVector3(number(2.2), number(1.7), number(1.6)));
            const btTransform mesh_pose = box_pose * relative;
            const auto space = bullet::only_face(mesh, mesh_pose, box, box_pose);
            if (!space) continue;
            std::vector<bullet::PlaneContact> below;
            bullet::plane_contacts(mesh, mesh_pose, *space, 0, below);
            double deepest = 0;
            Depths ours;
            for (const auto& c : below) {
                ours[c.vertex] = double(c.depth);
                deepest = std::max(deepest, double(c.depth));
            }
            ++over;
            // Deeper than a leg is thick, rays leave their own mesh first: the batch has fewer contacts there.
            if (deepest > 0.1) continue;
            Scene scene;
            const std::array pair{
                Pair{scene.add(shape, bullet::to_pose(mesh_pose)), scene.add(slab, bullet::to_pose(box_pose))}};
            Depths theirs;
            for (const Contact& c : scene.find_contacts(pair)) {
                EXPECT_EQ(c.feature.kind, FeatureKind::vertex) << i;
                EXPECT_EQ(c.feature.source, Side::a) << i;
                theirs[c.feature.source_index()] = double(c.depth);
            }
            for (const auto& [vertex, depth] : ours) {
                const std::uint32_t file_vertex = shape->vertex_index()[vertex];
                if (depth < 1e-5 || shape->exit_distances()[vertex] < 0.2f) continue;
                ++found_of_all;
                ASSERT_TRUE(theirs.contains(file_vertex)) << i << ": vertex " << vertex << ", " << depth;
                EXPECT_NEAR(theirs[file_vertex], depth, 1e-5) << i;
            }
            EXPECT_LE(theirs.size(), ours.size() + 1) << i;
        }
    }
    EXPECT_GT(over, 150);
    EXPECT_GT(found_of_all, 200);
}

TEST(BoxFace, RimsAndMiddleAreTheBatchs) {
    const btBoxShape box(btVector3(2, 2, btScalar(0.5)));
    const auto shape = Shape::make(box_mesh(1, 1, 1));
    const bullet::Converted mesh{shape, std::make_shared<bullet::BulletMesh>(shape)};
    const auto face = [&](double x, double y, double z) {
        return bullet::only_face(mesh, at(x, y, z), box, at(0, 0, 0));
    };
    ASSERT_TRUE(face(0, 0, 0.99));
    EXPECT_NEAR(face(0, 0, 0.99)->height, 0.5, 1e-6);
    EXPECT_EQ(face(0, 0, 0.99)->normal, btVector3(0, 0, 1));
    ASSERT_TRUE(face(1.49, 0, -0.99));
    EXPECT_EQ(face(1.49, 0, -0.99)->normal, btVector3(0, 0, -1));
    EXPECT_FALSE(face(1.51, 0, 0.99)); // beyond a rim
    EXPECT_FALSE(face(0, 0, 0.4));     // below the middle
    EXPECT_FALSE(face(1.6, 1.6, 0.7)); // at a corner
    const btBoxShape small(btVector3(1, 1, 1) / 4);
    EXPECT_FALSE(bullet::only_face(mesh, at(0, 0, 0.7), small, at(0, 0, 0))); // larger than the face
}

/// Pushes a plank over the rim until it tips: it must not jump. Returns the steps whose contacts are of the plane of a
/// face, and those whose contacts are the batch's.
std::array<int, 2> slide_over_the_rim(const Settings& settings) {
    TestWorld w(settings);
    w.add(std::make_unique<btBoxShape>(btVector3(2, 2, btScalar(0.5))), 0, at(0, 0, -0.5));
    btRigidBody& plank = w.add_mesh(Shape::make(box_mesh(1, 0.4, 0.1)), 2, at(1, 0, 0.05));
    plank.setFriction(0);
    w.steps(60);
    std::array<int, 2> steps{};
    while (plank.getWorldTransform().getOrigin().x() < 1.9) {
        plank.setLinearVelocity(btVector3(btScalar(0.5), 0, plank.getLinearVelocity().z()));
        w.steps(1);
        steps[0] += static_cast<int>(w.dispatcher.stats().plane_pairs);
        steps[1] += static_cast<int>(w.dispatcher.stats().mesh_pairs);
        EXPECT_NEAR(double(plank.getWorldTransform().getOrigin().z()), 0.05, 0.004);
        EXPECT_LT(std::fabs(double(plank.getLinearVelocity().z())), 0.05);
    }
    return steps;
}

TEST(BoxFace, SlidesOverTheRimWithoutAJump) {
    Settings touching;
    touching.speculative = Speculative::off;
    const auto [by_face, by_batch] = slide_over_the_rim(touching);
    EXPECT_GT(by_face, 20);
    EXPECT_GT(by_batch, 20);
}

TEST(BoxFace, TheBatchHasAllWhereContactsAreSpeculative) {
    const auto [by_face, by_batch] = slide_over_the_rim({});
    EXPECT_EQ(by_face, 0);
    EXPECT_GT(by_batch, 100);
}

} // namespace
} // namespace raycontact::test
