// SPDX-License-Identifier: Apache-2.0
// Edges of two open meshes: what is behind a sheet comes out at its front.
#include "property/shapes.h"
#include "reference/meshes.h"
#include "reference/random.h"
#include "reference/vector.h"

#include <raycontact/collide.h>
#include <raycontact/query.h>
#include <raycontact/scene.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace raycontact {
namespace {

using namespace reference;

constexpr double slack = 1e-5; // some perturbations, and float32

// Looks along the cross product of its sides.
std::shared_ptr<const Shape> quad(const Vec3& o, const Vec3& u, const Vec3& v) {
    return Shape::make(Mesh{"quad", {o, o + u, o + u + v, o + v}, {{0, 1, 2}, {0, 2, 3}}});
}
std::shared_ptr<const Shape> floor_quad() {
    return quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
}

Pose at(const Vec3& p) {
    Pose pose;
    pose.translation = p;
    return pose;
}

bool any_of_edges(const std::vector<Contact>& contacts) {
    return std::ranges::any_of(contacts, [](const Contact& c) { return c.feature.kind == FeatureKind::edges; });
}

// Where b is once it has gone along a contact.
Pose pushed(Pose pose, const Contact& c) {
    const double depth = double(c.depth) + slack;
    pose.translation = pose.translation + Vec3{depth * c.normal.x, depth * c.normal.y, depth * c.normal.z};
    return pose;
}

TEST(Sheets, StripThroughASheetGoesBackThroughItsFront) {
    const auto sheet = floor_quad(), strip = quad({0.1, -0.25, -0.2}, {0, 0.5, 0}, {0, 0, 1.2});
    const auto contacts = collide(*sheet, {}, *strip, {});
    ASSERT_EQ(contacts.size(), 2u) << "one of each side";
    for (const Contact& c : contacts) {
        EXPECT_EQ(c.feature.kind, FeatureKind::edges);
        EXPECT_NEAR(c.depth, 0.2, slack);
        EXPECT_NEAR(c.normal.z, 1, slack);
    }
    for (const Contact& c : collide(*strip, {}, *sheet, {})) EXPECT_NEAR(c.normal.z, -1, slack);
    // From the other side all but 0.2 of it is behind.
    const auto ceiling = quad({-1, -1, 0}, {0, 2, 0}, {2, 0, 0});
    for (const Contact& c : collide(*ceiling, {}, *strip, {})) {
        EXPECT_NEAR(c.depth, 1, slack);
        EXPECT_NEAR(c.normal.z, -1, slack);
    }
}

TEST(Sheets, CrossedQuadsComeApartByEachContact) {
    const auto sheet = floor_quad(), wall = quad({0.1, 0.5, -0.3}, {0, 1, 0}, {0, 0, 1.3}); // past the sheet's border
    const auto contacts = collide(*sheet, {}, *wall, {});
    ASSERT_EQ(contacts.size(), 2u) << "the wall's border below the sheet, the sheet's behind the wall";
    for (const Contact& c : contacts) {
        EXPECT_TRUE(std::fabs(c.depth - 0.3) < slack || std::fabs(c.depth - 1.1) < slack) << c.depth;
        EXPECT_FALSE(intersects(*sheet, {}, *wall, pushed({}, c)));
    }
}

TEST(Sheets, GridsThatCrossHaveAContactAndComeApart) {
    const Subject a(sheet_mesh(8)), b(bowl_mesh(8));
    Random random(20130906);
    int crossing = 0, apart = 0;
    for (int i = 0; i < 200; ++i) {
        Pose pose = random.rotation();
        pose.translation = 0.5 * a.solid.diagonal * random.in_ball();
        if (!intersects(*a.shape, {}, *b.shape, pose)) continue;
        ++crossing;
        bool touch = true;
        for (int turn = 0; turn < 12 && touch; ++turn) {
            const auto contacts = collide(*a.shape, {}, *b.shape, pose);
            ASSERT_FALSE(contacts.empty()) << "pose " << i << ", turn " << turn;
            pose = pushed(pose, *std::ranges::max_element(contacts, {}, &Contact::depth));
            touch = intersects(*a.shape, {}, *b.shape, pose);
        }
        apart += touch ? 0 : 1;
    }
    EXPECT_GE(crossing, 100);
    EXPECT_GE(100 * apart, 95 * crossing);
}

TEST(Sheets, WhatDoesNotCrossHasNoContactOfEdges) {
    const auto up = floor_quad(), down = quad({-1, -1, 0}, {0, 2, 0}, {2, 0, 0}),
               strip = quad({0.1, -0.25, 0}, {0, 0.5, 0}, {0, 0, 1});
    for (const double height : {0.1, 1e-3, -1e-3, -0.1}) {
        EXPECT_FALSE(any_of_edges(collide(*up, {}, *up, at({0.3, 0.2, height})))) << height;
        EXPECT_FALSE(any_of_edges(collide(*up, {}, *down, at({0.3, 0.2, height})))) << height;
    }
    EXPECT_TRUE(collide(*up, {}, *down, at({0.3, 0.2, 0.1})).empty()) << "in front of each other";
    EXPECT_TRUE(collide(*up, {}, *strip, at({0, 0, 1e-3})).empty());
    // Flush.
    EXPECT_FALSE(any_of_edges(collide(*up, {}, *up, at({0.3, 0.2, 0}))));
    EXPECT_FALSE(any_of_edges(collide(*up, {}, *down, at({0.3, 0.2, 0}))));
    EXPECT_FALSE(any_of_edges(collide(*up, {}, *strip, {})));
}

TEST(Sheets, MethodsAgreeWhileAStripFallsThroughASheet) {
    const auto sheet = floor_quad(), strip = quad({0.1, -0.25, 0}, {0, 0.5, 0}, {0, 0, 1});
    Settings settings;
    settings.method = Method::standard;
    Scene standard(settings);
    settings.method = Method::certified;
    Scene certified(settings);
    for (Scene* scene : {&standard, &certified}) scene->add(sheet);
    const BodyId strips[] = {standard.add(strip), certified.add(strip)};
    int steps = 0;
    for (int i = 0; i < 60; ++i) {
        std::vector<Contact> found[2];
        for (std::size_t k = 0; k < 2; ++k) {
            Scene& scene = k == 0 ? standard : certified;
            scene.set_pose(strips[k], at({0, 0, 0.205 - 0.01 * i}));
            const auto contacts = scene.find_contacts();
            found[k].assign(contacts.begin(), contacts.end());
        }
        ASSERT_TRUE(same_bits(found[0], found[1])) << i;
        EXPECT_EQ(found[0].size(), i > 20 ? 2u : 0u) << i;
        steps += found[0].empty() ? 0 : 1;
    }
    EXPECT_EQ(steps, 39);
}

} // namespace
} // namespace raycontact
