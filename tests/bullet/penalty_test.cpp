// SPDX-License-Identifier: Apache-2.0
// Springs and dampers at the contacts, by hand and beside Bullet's sequential impulses.
#include "test_world.h"

#include "penalty_world.h"
#include <raycontact/bullet/recommend.h>
#include <scenes/models/procedural.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace raycontact::test {
namespace {

constexpr double gravity = 9.81, density = 1000;
constexpr double step = 1.0 / 1200;

Contact contact_of(float depth) {
    Contact contact;
    contact.normal = {0, 0, 1};
    contact.depth = depth;
    return contact;
}

TEST(Penalty, PressesAlongTheNormalAndNeverPulls) {
    const Penalty penalty{.stiffness = 1000, .damping = 50};
    const Contact contact = contact_of(0.25f);
    EXPECT_EQ(penalty_force(penalty, contact), (Vec3{0, 0, 250}));
    EXPECT_EQ(penalty_force(penalty, contact, {0, 0, -2}), (Vec3{0, 0, 350}));
    EXPECT_EQ(penalty_force(penalty, contact, {0, 0, 2}), (Vec3{0, 0, 150}));
    EXPECT_EQ(penalty_force(penalty, contact, {0, 0, 6}), Vec3{});
    EXPECT_EQ(penalty_force(penalty, contact, {3, 0, 0}), (Vec3{0, 0, 250})); // no friction was asked for
    EXPECT_EQ(penalty_force(penalty, contact_of(-0.25f)), Vec3{});            // speculative
    Contact weighted = contact;
    weighted.weight = 0.5f;
    EXPECT_EQ(penalty_force(penalty, weighted, {0, 0, -2}), (Vec3{0, 0, 175}));
}

TEST(Penalty, FrictionStaysInItsCone) {
    const Penalty penalty{.stiffness = 1000, .friction = 0.5, .slip_speed = 0.1};
    const Contact contact = contact_of(0.25f);
    const Vec3 fast = penalty_force(penalty, contact, {3, 4, 0});
    EXPECT_NEAR(fast.x, -75, 1e-9);
    EXPECT_NEAR(fast.y, -100, 1e-9);
    EXPECT_EQ(fast.z, 250);
    EXPECT_NEAR(penalty_force(penalty, contact, {0.05, 0, 0}).x, -62.5, 1e-9);
    EXPECT_EQ(penalty_force(penalty, contact).x, 0);
}

/// With which a body sinks in by `depth` at rest on so many contacts, damped as much as is critical.
Penalty springs_for(double mass, double depth, double contacts, double friction = 0) {
    const double stiffness = mass * gravity / (depth * contacts);
    return {.stiffness = stiffness, .damping = 2 * std::sqrt(stiffness * mass / contacts), .friction = friction};
}

Settings settings_of(Direction direction = Direction::reprojected) {
    Settings settings;
    settings.features = Features::vertices;
    settings.direction = direction;
    return settings;
}

std::shared_ptr<const Shape> slab() {
    static const auto shape = Shape::make(box_mesh(20, 20, 1));
    return shape;
}
constexpr Pose under_the_ground{.translation = {0, 0, -0.5}};

TEST(Penalty, ABodyRestsAsDeepAsItsWeightPredicts) {
    constexpr double size = 0.5, depth = 0.002, mass = density * size * size * size;
    PenaltyWorld world(springs_for(mass, depth, 4), settings_of());
    world.add(slab(), 0, under_the_ground);
    const auto box =
        world.add(Shape::make(box_mesh(size, size, size)), density, {.translation = {0, 0, size / 2 + 0.1}});
    ASSERT_NEAR(world.mass(box), mass, 1e-6 * mass);
    for (int i = 0; i < 2400; ++i) world.step(step);
    EXPECT_EQ(world.scene().contacts().size(), 4u);
    EXPECT_NEAR(size / 2 - world.pose(box).translation.z, depth, 1e-3 * depth);
    EXPECT_LT(std::fabs(world.velocity(box).z), 1e-6);
}

// Weights differ from corner to corner, so the body tilts; all together they carry it.
TEST(Penalty, WeightedForcesCarryTheWeight) {
    const auto shape = Shape::make(scenes::bumpy_sphere(902));
    constexpr double stiffness = 2e7; // N/m^3
    PenaltyWorld world({.stiffness = stiffness, .damping = 2e5, .friction = 0.5}, settings_of(Direction::weighted));
    world.add(slab(), 0, under_the_ground);
    const auto body = world.add(shape, density, {.translation = {0, 0, 0.55}});
    for (int i = 0; i < 12000; ++i) world.step(step);
    double pressure = 0;
    for (const Contact& c : world.scene().contacts()) {
        const double along = std::fabs(static_cast<double>(c.normal.z)); // a ray's direction is not the plane's
        pressure += static_cast<double>(c.weight) * static_cast<double>(c.depth) * along;
    }
    EXPECT_NEAR(stiffness * pressure, world.mass(body) * gravity, 0.05 * world.mass(body) * gravity);
}

// Between two bounces a body has what springs gave back, and less where dampers took of it.
TEST(Penalty, EnergyDoesNotGrow) {
    const auto shape = Shape::make(scenes::bumpy_torus(902));
    for (const double damping : {0.0, 500.0}) {
        PenaltyWorld world({.stiffness = 2e5, .damping = damping}, settings_of());
        world.add(slab(), 0, under_the_ground);
        world.add(shape, density, {.rotation = {0.8, 0, 0.6, 0, 1, 0, -0.6, 0, 0.8}, .translation = {0, 0, 0.8}});
        world.step(step);
        const double first = world.energy();
        double before = first;
        int flights = 0;
        bool flew = true;
        for (int i = 0; i < 6000; ++i) {
            world.step(step);
            const bool flies = world.scene().contacts().empty();
            if (flies && !flew) {
                ++flights;
                if (damping > 0) {
                    EXPECT_LT(world.energy(), before);
                } else {
                    EXPECT_NEAR(world.energy(), first, 0.005 * first);
                }
                before = world.energy();
            }
            flew = flies;
        }
        EXPECT_GE(flights, 3) << damping;
        if (damping > 0) {
            EXPECT_LT(world.energy(), 0.6 * first);
        }
    }
}

struct Bullet : TestWorld {
    explicit Bullet(const Vec3& pull) : TestWorld(settings_of()) {
        bullet::recommend(world);
        world.setGravity(btVector3(btScalar(pull.x), btScalar(pull.y), btScalar(pull.z)));
        add_mesh(slab(), 0, at(0, 0, -0.5)).setFriction(1);
    }
};

TEST(Penalty, ATableStandsWhereSequentialImpulsesPutIt) {
    constexpr double mass = 5, depth = 0.002, height = 0.45;
    Bullet impulses({0, 0, -gravity});
    const btRigidBody& stands = impulses.add_mesh(table(), mass, at(0.1, 0.2, height));
    impulses.steps(180);

    const double volume = table()->report().volume;
    const double contacts = 16; // four legs of four corners
    PenaltyWorld springs(springs_for(mass, depth, contacts, 0.5), settings_of());
    springs.add(slab(), 0, under_the_ground);
    const auto body = springs.add(table(), mass / volume, {.translation = {0.1, 0.2, height}});
    for (int i = 0; i < 3600; ++i) springs.step(step);

    const Pose& pose = springs.pose(body);
    const btVector3& place = stands.getWorldTransform().getOrigin();
    EXPECT_NEAR(pose.translation.x, double(place.x()), 0.001);
    EXPECT_NEAR(pose.translation.y, double(place.y()), 0.001);
    EXPECT_NEAR(pose.translation.z + depth, double(place.z()), 0.0015);
    EXPECT_NEAR(pose.rotation[8], double(stands.getWorldTransform().getBasis()[2][2]), 1e-4);
}

/// Metres a second, of a flat box after a second on a slope.
struct Slide {
    double springs, impulses;
};
Slide slide(double slope, double friction) {
    const double angle = std::atan(slope);
    const Vec3 pull{gravity * std::sin(angle), 0, -gravity * std::cos(angle)};
    const auto shape = Shape::make(box_mesh(1, 1, 0.25));
    const double mass = density * 0.25, depth = 0.002;
    PenaltyWorld springs(springs_for(mass, depth, 4, friction), settings_of(), pull);
    springs.add(slab(), 0, under_the_ground);
    const auto body = springs.add(shape, density, {.translation = {0, 0, 0.125 - depth}});
    for (int i = 0; i < 1200; ++i) springs.step(step);

    Bullet impulses(pull);
    btRigidBody& slides = impulses.add_mesh(shape, mass, at(0, 0, 0.125));
    slides.setFriction(btScalar(friction)); // Bullet multiplies the bodies' coefficients
    impulses.steps(60);
    return {springs.velocity(body).x, double(slides.getLinearVelocity().x())};
}

TEST(Penalty, FrictionHoldsOnASlopeUpToTheSameAngle) {
    constexpr double friction = 0.5;
    const Slide held = slide(0.4, friction);
    EXPECT_LT(std::fabs(held.impulses), 1e-3);
    EXPECT_NEAR(held.springs, 0.01 * 0.4 / friction, 1e-3); // creeps, slower than the slip speed
    const Slide slid = slide(0.7, friction);
    const double angle = std::atan(0.7), speed = gravity * (std::sin(angle) - friction * std::cos(angle));
    EXPECT_NEAR(slid.springs, speed, 0.03 * speed);
    EXPECT_NEAR(slid.impulses, speed, 0.05 * speed);
}

} // namespace
} // namespace raycontact::test
