// SPDX-License-Identifier: Apache-2.0
// Levels of games are open meshes, wound one way or the other. Bullet's convex shapes stand on them in any case.
#include "test_world.h"

#include <raycontact/bullet/recommend.h>

#include <BulletCollision/CollisionShapes/btTriangleMesh.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>

namespace raycontact::test {
namespace {

enum class Wound { up, down, mixed };

/// A floor of 8 x 8 m at z = 0, four triangles a square metre. mixed: half of it is another part, wound otherwise.
std::unique_ptr<btTriangleMesh> level(Wound wound) {
    auto mesh = std::make_unique<btTriangleMesh>();
    const auto corner = [](int i, int k) { return btVector3(btScalar(0.5 * i - 4), btScalar(0.5 * k - 4), 0); };
    for (int i = 0; i < 16; ++i)
        for (int k = 0; k < 16; ++k) {
            const bool up = wound == Wound::up || (wound == Wound::mixed && i < 8);
            const btVector3 a = corner(i, k), b = corner(i + 1, k), c = corner(i + 1, k + 1), d = corner(i, k + 1);
            up ? mesh->addTriangle(a, b, c) : mesh->addTriangle(a, c, b);
            up ? mesh->addTriangle(a, c, d) : mesh->addTriangle(a, d, c);
        }
    return mesh;
}

btRigidBody& add_level(TestWorld& w, btTriangleMesh& mesh) {
    return w.add(std::make_unique<btBvhTriangleMeshShape>(&mesh, true), 0, at(0, 0, 0));
}

using MakeShape = std::function<std::unique_ptr<btCollisionShape>()>;

/// All of them 0.2 m above the floor where they rest.
const std::vector<std::pair<std::string, MakeShape>> shapes{
    {"box", [] { return std::make_unique<btBoxShape>(btVector3(btScalar(0.2), btScalar(0.2), btScalar(0.2))); }},
    {"ball", [] { return std::make_unique<btSphereShape>(btScalar(0.2)); }},
    {"capsule", [] { return std::make_unique<btCapsuleShapeX>(btScalar(0.2), btScalar(0.5)); }},
    {"cylinder",
     [] { return std::make_unique<btCylinderShapeZ>(btVector3(btScalar(0.2), btScalar(0.2), btScalar(0.2))); }},
};

TEST(OpenLevel, ConvexShapesStandOnIt) {
    for (const Wound wound : {Wound::up, Wound::down, Wound::mixed}) {
        const auto mesh = level(wound);
        for (const auto& [name, make] : shapes) {
            TestWorld w;
            add_level(w, *mesh);
            for (const double x : {-2.2, 0.0, 2.3}) w.add(make(), 1, at(x, 0.1, 1.2));
            w.steps(180);
            for (std::size_t i = 1; i < w.bodies.size(); ++i) {
                EXPECT_NEAR(double(w.bodies[i]->getWorldTransform().getOrigin().z()), 0.2, 0.012)
                    << name << ", wound " << static_cast<int>(wound);
                EXPECT_LT(double(w.bodies[i]->getLinearVelocity().length()), 0.05) << name;
            }
            EXPECT_EQ(w.dispatcher.stats().one_sided_pairs, 0u);
            EXPECT_EQ(w.dispatcher.stats().two_sided_pairs + w.dispatcher.stats().round_pairs, 3u) << name;
        }
    }
}

TEST(OpenLevel, OursIsOneSidedWhereAskedFor) {
    const auto mesh = level(Wound::down);
    TestWorld w({}, {}, bullet::ConvexShapes::ours);
    add_level(w, *mesh);
    const btRigidBody& body = w.add(shapes[0].second(), 1, at(0, 0, 1));
    w.steps(120);
    EXPECT_LT(double(body.getWorldTransform().getOrigin().z()), -1);
}

// From both sides: the level's own winding does not matter, so one is enough.
TEST(OpenLevel, NothingFastPasses) {
    const auto mesh = level(Wound::up);
    for (const auto& [name, make] : shapes) {
        for (const double speed : {5.0, 20.0, 60.0}) {
            for (const double side : {1.0, -1.0}) {
                for (int i = 0; i < 6; ++i) {
                    TestWorld w;
                    w.world.setGravity(btVector3(0, 0, 0));
                    add_level(w, *mesh);
                    const double height = 2 + speed / 60 * i / 6;
                    btRigidBody& body = w.add(make(), 1, at(0.13, 0.21, side * height));
                    body.setLinearVelocity(btVector3(btScalar(0.2 * speed), 0, btScalar(-side * speed)));
                    w.steps(static_cast<int>(60 * 2.5 / speed) + 3);
                    EXPECT_GT(side * double(body.getWorldTransform().getOrigin().z()), 0)
                        << name << " at " << speed << " m/s from side " << side << ", flight " << i;
                }
            }
        }
    }
}

// No edge between two triangles of the floor stops what slides over it.
TEST(OpenLevel, WhatSlidesGoesOn) {
    for (const Wound wound : {Wound::up, Wound::down}) {
        const auto mesh = level(wound);
        for (const auto& [name, make] : shapes) {
            TestWorld w;
            add_level(w, *mesh).setFriction(0);
            btRigidBody& body = w.add(make(), 1, at(-3.5, 0.1, 0.2));
            body.setFriction(0);
            body.setAngularFactor(0);
            w.steps(30);
            body.setLinearVelocity(btVector3(20, 0, 0));
            w.steps(18);
            EXPECT_NEAR(double(body.getWorldTransform().getOrigin().x()), 2.5, 0.1) << name;
            EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.2, 0.02) << name;
        }
    }
}

/// Two triangles: from `corner` along `one` and `two`.
std::unique_ptr<btTriangleMesh> sheet(const btVector3& corner, const btVector3& one, const btVector3& two) {
    auto mesh = std::make_unique<btTriangleMesh>();
    mesh->addTriangle(corner, corner + one, corner + one + two);
    mesh->addTriangle(corner, corner + one + two, corner + two);
    return mesh;
}

// A fence, 1 m high: whatever comes down on its border, at any speed, lies on it, and is not pushed aside.
TEST(OpenLevel, ABorderCarriesWhatComesDownOnIt) {
    for (const bool turned : {false, true}) {
        const btVector3 along = turned ? btVector3(-8, 0, 0) : btVector3(8, 0, 0);
        const auto mesh = sheet(btVector3(turned ? 4 : -4, 0, 0), along, btVector3(0, 0, 1));
        for (const auto& [name, make] : shapes) {
            if (name == "ball" || name == "capsule") continue; // in closed form
            for (const double speed : {0.0, 5.0, 20.0, 60.0}) {
                TestWorld w;
                add_level(w, *mesh);
                btRigidBody& body = w.add(make(), 1, at(0.13, 0.07, 1.9 + speed / 60));
                body.setAngularFactor(0);
                body.setLinearVelocity(btVector3(0, 0, btScalar(-speed)));
                double lowest = 9;
                for (int i = 0; i < 120; ++i) {
                    w.steps(1);
                    lowest = std::min(lowest, double(body.getWorldTransform().getOrigin().z()));
                }
                const btVector3& end = body.getWorldTransform().getOrigin();
                EXPECT_GT(lowest, 1.18) << name << " at " << speed;
                EXPECT_NEAR(double(end.z()), 1.2, 0.003) << name << " at " << speed;
                EXPECT_NEAR(double(end.y()), 0.07, 0.001) << name << " at " << speed;
                EXPECT_LT(double(body.getLinearVelocity().length()), 0.005) << name << " at " << speed;
            }
        }
    }
}

// A sheet that comes to the middle of a side is a wall, as thin as it is.
TEST(OpenLevel, ABorderStopsWhatComesToItFromTheSide) {
    const auto mesh = sheet(btVector3(0, -4, 0), btVector3(0, 8, 0), btVector3(8, 0, 0));
    for (const auto& [name, make] : shapes) {
        if (name == "ball" || name == "capsule") continue;
        for (const double speed : {1.0, 5.0, 20.0, 60.0}) {
            TestWorld w;
            w.world.setGravity(btVector3(0, 0, 0));
            add_level(w, *mesh).setFriction(0);
            btRigidBody& body = w.add(make(), 1, at(-1 - speed / 60, 0.1, 0.03));
            body.setAngularFactor(0);
            body.setLinearVelocity(btVector3(btScalar(speed), 0, 0));
            double farthest = -9;
            for (int i = 0; i < static_cast<int>(60 * 1.5 / speed) + 60; ++i) {
                w.steps(1);
                farthest = std::max(farthest, double(body.getWorldTransform().getOrigin().x()));
            }
            EXPECT_NEAR(farthest, -0.2, 0.003 + 0.01 * speed / 60) << name << " at " << speed;
            // A cylinder slides on along the side of its polygon that comes first.
            if (name == "box") {
                EXPECT_NEAR(double(body.getLinearVelocity().length()), 0, 1e-3) << speed;
            }
            EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.03, 0.001) << name << " at " << speed;
        }
    }
}

// From one sheet to another that is flush with it, by its border, and on over the last border: nothing is felt.
TEST(OpenLevel, BordersOfFlushSheetsAreNoWalls) {
    for (const double step : {0.0, 0.0002, -0.0002})
        for (const Wound wound : {Wound::up, Wound::down}) {
            const auto near = wound == Wound::up ? sheet(btVector3(-4, -1, 0), btVector3(4, 0, 0), btVector3(0, 2, 0))
                                                 : sheet(btVector3(-4, -1, 0), btVector3(0, 2, 0), btVector3(4, 0, 0));
            const auto far = sheet(btVector3(0, -1, btScalar(step)), btVector3(4, 0, 0), btVector3(0, 2, 0));
            for (const auto& [name, make] : shapes) {
                if (name == "ball" || name == "capsule") continue;
                for (const double speed : {1.0, 5.0, 20.0}) {
                    TestWorld w;
                    add_level(w, *near).setFriction(0);
                    add_level(w, *far).setFriction(0);
                    btRigidBody& body = w.add(make(), 1, at(-1, 0.1, 0.2));
                    bullet::recommend(w.world);
                    w.steps(30);
                    body.setLinearVelocity(btVector3(btScalar(speed), 0, 0));
                    w.steps(static_cast<int>(60 * 2 / speed));
                    EXPECT_NEAR(double(body.getLinearVelocity().x()), speed, 0.01 * speed) << name << ", step " << step;
                    EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.2, 0.003) << name;
                    EXPECT_LT(double(body.getAngularVelocity().length()), 0.02) << name << ", step " << step;
                }
            }
        }
}

// A sheet smaller than what lies on it carries it by its border alone.
TEST(OpenLevel, ASmallSheetCarriesALargeBox) {
    for (const double side : {1.0, -1.0}) {
        const auto mesh = sheet(btVector3(btScalar(-0.05), btScalar(-0.05), 0), btVector3(btScalar(0.1), 0, 0),
                                btVector3(0, btScalar(0.1 * side), 0));
        TestWorld w;
        add_level(w, *mesh);
        const double y = side > 0 ? 0 : -0.1;
        const btRigidBody& body = w.add(shapes[0].second(), 1, at(0, y, 0.3));
        w.steps(180);
        EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 0.2, 0.003);
        EXPECT_LT(double(body.getLinearVelocity().length()), 0.005);
        EXPECT_GT(double(body.getWorldTransform().getBasis()[2][2]), 0.9999);
    }
}

// A beam across the ridge of a roof: two edges meet. Any winding, first corner, and order of bodies.
TEST(OpenLevel, EdgesAreFoundOnBothSides) {
    const btVector3 ridge0(0, -1, 0), ridge1(0, 1, 0), left0(-1, -1, -1), left1(-1, 1, -1), right0(1, -1, -1),
        right1(1, 1, -1);
    const std::vector<std::array<btVector3, 3>> up{
        {ridge0, ridge1, left1}, {ridge0, left1, left0}, {ridge1, ridge0, right0}, {ridge1, right0, right1}};
    for (const bool down : {false, true})
        for (const std::size_t first : {0u, 1u, 2u})
            for (const bool beam_first : {false, true}) {
                btTriangleMesh mesh;
                for (const auto& t : up) {
                    const btVector3 &a = t[first], &b = t[(first + 1) % 3], &c = t[(first + 2) % 3];
                    down ? mesh.addTriangle(a, c, b) : mesh.addTriangle(a, b, c);
                }
                TestWorld w;
                const auto add_beam = [&]() -> btRigidBody& {
                    const btVector3 half(btScalar(0.4), btScalar(0.05), btScalar(0.05));
                    btRigidBody& beam = w.add(std::make_unique<btBoxShape>(half), 1, at(0.02, 0.1, 0.3));
                    beam.setAngularFactor(0);
                    return beam;
                };
                const btRigidBody* beam = beam_first ? &add_beam() : nullptr;
                add_level(w, mesh);
                if (!beam_first) beam = &add_beam();
                w.steps(120);
                EXPECT_NEAR(double(beam->getWorldTransform().getOrigin().z()), 0.05, 0.003)
                    << "down " << down << ", first corner " << first << ", beam first " << beam_first;
                EXPECT_LT(double(beam->getLinearVelocity().length()), 0.005);
            }
}

// A floor that ends at a wall down: what hangs over by less than half lies still.
TEST(OpenLevel, AKerbDoesNotPush) {
    for (const bool down : {false, true})
        for (const double cell : {0.1, 0.5, 2.0})
            for (const double x : {-0.25, -0.1, -0.02}) {
                btTriangleMesh mesh;
                const auto add = [&](const btVector3& a, const btVector3& one, const btVector3& two) {
                    const btVector3 b = a + one, c = a + one + two, d = a + two;
                    down ? mesh.addTriangle(a, c, b) : mesh.addTriangle(a, b, c);
                    down ? mesh.addTriangle(a, d, c) : mesh.addTriangle(a, c, d);
                };
                const auto s = static_cast<btScalar>(cell);
                const int cells = static_cast<int>(std::lround(4 / cell)) / 2;
                for (int i = 0; i < cells; ++i)
                    for (int k = 0; k < 2 * cells; ++k) {
                        const btScalar y = s * btScalar(k - cells);
                        add(btVector3(-s * btScalar(i + 1), y, 0), btVector3(s, 0, 0), btVector3(0, s, 0));
                        add(btVector3(0, y, -s * btScalar(i + 1)), btVector3(0, s, 0), btVector3(0, 0, s));
                    }
                TestWorld w;
                add_level(w, mesh);
                const btRigidBody& body = w.add(shapes[0].second(), 1, at(x, 0.03, 0.2));
                bullet::recommend(w.world);
                w.steps(240);
                const btVector3& end = body.getWorldTransform().getOrigin();
                EXPECT_NEAR(double(end.z()), 0.2, 0.001) << down << ' ' << cell << ' ' << x;
                EXPECT_NEAR(double(end.x()), x, 0.003) << down << ' ' << cell << ' ' << x;
                EXPECT_NEAR(double(end.y()), 0.03, 0.003) << down << ' ' << cell << ' ' << x;
                EXPECT_LT(double(body.getLinearVelocity().length()), 0.005) << down << ' ' << cell << ' ' << x;
            }
}

// A fence whose triangles are there twice, or that has a decal on it up to its border.
TEST(OpenLevel, WhatLiesOnASheetDoesNotEndItsBorder) {
    for (const int kind : {0, 1, 2}) {
        const btVector3 corner(-4, 0, 0), one(8, 0, 0), two(0, 0, 1);
        const auto mesh = sheet(corner, one, two);
        if (kind == 0) mesh->addTriangle(corner, corner + one + two, corner + two);
        if (kind == 1) mesh->addTriangle(corner, corner + two, corner + one + two);
        if (kind == 2)
            mesh->addTriangle(btVector3(btScalar(-0.2), 0, btScalar(0.5)), btVector3(btScalar(0.2), 0, btScalar(0.5)),
                              btVector3(0, 0, 1));
        TestWorld w;
        add_level(w, *mesh);
        btRigidBody& body = w.add(shapes[0].second(), 1, at(0.13, 0.07, 1.5));
        body.setAngularFactor(0);
        w.steps(120);
        EXPECT_NEAR(double(body.getWorldTransform().getOrigin().z()), 1.2, 0.003) << kind;
    }
}

// What lies over the end of a sheet by less than half stays; by more, it tips.
TEST(OpenLevel, WhatHangsOverABorderTipsByItsWeight) {
    const auto mesh = sheet(btVector3(-4, -1, 0), btVector3(4, 0, 0), btVector3(0, 2, 0));
    for (const double x : {-0.05, -0.01, 0.01, 0.05}) {
        TestWorld w;
        add_level(w, *mesh);
        const btRigidBody& body = w.add(shapes[0].second(), 1, at(x, 0.1, 0.2));
        w.steps(240);
        EXPECT_EQ(double(body.getWorldTransform().getOrigin().z()) > 0.19, x < 0) << x;
        if (x < 0) {
            EXPECT_LT(double(body.getLinearVelocity().length()), 0.005) << x;
        }
    }
}

// A tray of five sheets in one mesh, wound inward or outward: what falls into it stays in it and comes to rest.
TEST(OpenLevel, ATrayHoldsWhatFallsIntoIt) {
    for (const bool inward : {true, false}) {
        btTriangleMesh mesh;
        const auto add = [&](const btVector3& a, const btVector3& one, const btVector3& two) {
            const btVector3 b = a + one, c = a + one + two, d = a + two;
            inward ? mesh.addTriangle(a, b, c) : mesh.addTriangle(a, c, b);
            inward ? mesh.addTriangle(a, c, d) : mesh.addTriangle(a, d, c);
        };
        const btVector3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 1), corner(-1, -1, 0);
        add(corner, x, y);
        add(corner, z, x);
        add(corner, y, z);
        add(corner + x, z, y);
        add(corner + y, x, z);
        TestWorld w;
        add_level(w, mesh);
        bullet::recommend(w.world, {.size = 0.4});
        for (int i = 0; i < 12; ++i) {
            btTransform pose =
                at(0.55 * (i % 3) - 0.55, 0.55 * (i / 3 % 2) - 0.3, 0.4 + 0.6 * static_cast<int>(i >= 6));
            pose.setRotation(btQuaternion(btVector3(1, 2, btScalar(i)).normalized(), btScalar(i)));
            w.add(shapes[i % 2 == 0 ? 0 : 3].second(), 1, pose);
        }
        w.steps(360);
        for (std::size_t i = 1; i < w.bodies.size(); ++i) {
            const btVector3& end = w.bodies[i]->getWorldTransform().getOrigin();
            EXPECT_TRUE(btFabs(end.x()) < 1 && btFabs(end.y()) < 1 && end.z() > 0.15) << i << ", inward " << inward;
            EXPECT_LT(double(w.bodies[i]->getLinearVelocity().length()), 0.1) << i << ", inward " << inward;
        }
    }
}

TEST(OpenLevel, QueriesFindBothSides) {
    for (const Wound wound : {Wound::up, Wound::down}) {
        const auto mesh = level(wound);
        for (const auto& [name, make] : shapes) {
            TestWorld w;
            btRigidBody& ground = add_level(w, *mesh);
            for (const double side : {1.0, -1.0}) {
                btRigidBody& body = w.add(make(), 1, at(0.1, 0.2, 0.19 * side));
                Count count;
                w.world.contactPairTest(&ground, &body, count);
                EXPECT_GT(count.points, 0) << name << ", from side " << side;
                w.remove(body);
            }
        }
    }
}

// A capsule whose axis goes through a sheet leaves it to the side where more of it is.
TEST(OpenLevel, ACapsuleThroughASheetLeavesByItsLongerSide) {
    for (const Wound wound : {Wound::up, Wound::down}) {
        const auto mesh = level(wound);
        for (const double side : {1.0, -1.0}) {
            TestWorld w;
            w.world.setGravity(btVector3(0, 0, 0));
            add_level(w, *mesh);
            const btRigidBody& body =
                w.add(std::make_unique<btCapsuleShapeZ>(btScalar(0.05), btScalar(0.6)), 1, at(0.1, 0.2, 0.2 * side));
            w.steps(120);
            EXPECT_GT(side * double(body.getWorldTransform().getOrigin().z()), 0.33);
        }
    }
}

TEST(OpenLevel, MeshBodiesAreToldOfOneSidedness) {
    const auto mesh = level(Wound::down);
    TestWorld w;
    std::vector<bullet::Fault> told;
    w.dispatcher.on_fault([&](const bullet::Fault& fault) { told.push_back(fault); });
    btRigidBody& ground = add_level(w, *mesh);
    ground.setUserIndex(7);
    w.add_mesh(table(), 5, at(-1, 0, 0.5));
    w.add_mesh(torus(), 5, at(2, 0, 0.5));
    std::uint64_t pairs = 0;
    for (int i = 0; i < 30; ++i) {
        w.steps(1);
        pairs = std::max(pairs, w.dispatcher.stats().one_sided_pairs);
    }
    EXPECT_EQ(pairs, 2u);
    ASSERT_EQ(told.size(), 1u);
    EXPECT_EQ(told[0].object, &ground);
    EXPECT_FALSE(told[0].left_out);
    EXPECT_NE(told[0].text.find("user index 7: its mesh is open"), std::string::npos) << told[0].text;
    EXPECT_TRUE(w.dispatcher.stats().left_out.empty());
}

} // namespace
} // namespace raycontact::test
