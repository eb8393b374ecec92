// SPDX-License-Identifier: Apache-2.0
#include <raycontact/mass.h>

#include "solids.h"

#include <gtest/gtest.h>

using namespace raycontact;
using namespace raycontact::test;

TEST(Mass, OfABox) {
    const double a = 2, b = 3, c = 5, mass = a * b * c;
    // Far from its origin as well: the moments are about the centre and must not lose digits.
    for (const Vec3& at : {Vec3{-1, -1.5, -2.5}, Vec3{1e4, -2e4, 3e4}}) {
        Mesh mesh;
        append_box(mesh, at, {at.x + a, at.y + b, at.z + c});
        const Mass got = mass_of(mesh.vertices, mesh.triangles);
        EXPECT_NEAR(got.volume, mass, 1e-10);
        EXPECT_NEAR(got.centre.x, at.x + a / 2, 1e-10);
        EXPECT_NEAR(got.centre.y, at.y + b / 2, 1e-10);
        EXPECT_NEAR(got.centre.z, at.z + c / 2, 1e-10);
        const double expected[9] = {mass * (b * b + c * c) / 12, 0, 0, 0, mass * (a * a + c * c) / 12, 0, 0, 0,
                                    mass * (a * a + b * b) / 12};
        for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(got.inertia[k], expected[k], 1e-8) << k;
    }
}

TEST(Mass, OfATetrahedron) {
    // The corner of the unit cube: volume 1/6, centre 1/4; about it, moments 1/80 and products of inertia 1/480.
    const Mesh mesh{
        "corner", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
    const Mass got = mass_of(mesh.vertices, mesh.triangles);
    EXPECT_NEAR(got.volume, 1.0 / 6, 1e-15);
    EXPECT_NEAR(got.centre.x, 0.25, 1e-15);
    EXPECT_NEAR(got.centre.y, 0.25, 1e-15);
    EXPECT_NEAR(got.centre.z, 0.25, 1e-15);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(got.inertia[3 * i + j], i == j ? 1.0 / 80 : 1.0 / 480, 1e-15);
}

TEST(Mass, OfASolidWoundInwardIsNegative) {
    Mesh mesh;
    append_box(mesh, {1, 1, 1}, {2, 3, 4}, false);
    const Mass got = mass_of(mesh.vertices, mesh.triangles);
    EXPECT_NEAR(got.volume, -6, 1e-12);
    EXPECT_NEAR(got.centre.z, 2.5, 1e-12);
    EXPECT_NEAR(got.inertia[0], -6.0 / 12 * (4 + 9), 1e-12);
}

TEST(Mass, OfNothingIsNone) {
    EXPECT_EQ(mass_of({}, {}).volume, 0);
    const Mesh sheet{"sheet", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
    const Mass got = mass_of(sheet.vertices, sheet.triangles);
    EXPECT_EQ(got.volume, 0);
    EXPECT_EQ(got.centre, Vec3{});
}
