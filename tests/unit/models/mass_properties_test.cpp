// SPDX-License-Identifier: Apache-2.0
#include <raycontact/error.h>
#include <scenes/models/mass_properties.h>
#include <scenes/models/procedural.h>

#include <gtest/gtest.h>

using namespace raycontact;
using namespace raycontact::scenes;

namespace {

Mesh box(double a, double b, double c, const Vec3& at) {
    Mesh mesh{"box", {}, {}};
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back({at.x + (i & 1 ? a : 0), at.y + (i & 2 ? b : 0), at.z + (i & 4 ? c : 0)});
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

} // namespace

TEST(MassProperties, OfABox) {
    const double a = 2, b = 3, c = 5, mass = a * b * c;
    // Far from its origin as well: the moments are about the centre and must not lose digits.
    for (const Vec3& at : {Vec3{-1, -1.5, -2.5}, Vec3{1e4, -2e4, 3e4}}) {
        const MassProperties got = mass_properties(prepare_mesh(box(a, b, c, at)));
        EXPECT_NEAR(got.volume, mass, 1e-10);
        EXPECT_NEAR(got.centre.x, at.x + a / 2, 1e-10);
        EXPECT_NEAR(got.centre.y, at.y + b / 2, 1e-10);
        EXPECT_NEAR(got.centre.z, at.z + c / 2, 1e-10);
        const double expected[9] = {mass * (b * b + c * c) / 12, 0, 0, 0, mass * (a * a + c * c) / 12, 0, 0, 0,
                                    mass * (a * a + b * b) / 12};
        for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(got.inertia[k], expected[k], 1e-8) << k;
    }
}

TEST(MassProperties, OfATetrahedron) {
    // The corner of the unit cube: volume 1/6, centre 1/4; about it, moments 1/80 and products of inertia 1/480.
    const Mesh mesh{
        "corner", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
    const MassProperties got = mass_properties(prepare_mesh(mesh));
    EXPECT_NEAR(got.volume, 1.0 / 6, 1e-15);
    EXPECT_NEAR(got.centre.x, 0.25, 1e-15);
    EXPECT_NEAR(got.centre.y, 0.25, 1e-15);
    EXPECT_NEAR(got.centre.z, 0.25, 1e-15);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(got.inertia[3 * i + j], i == j ? 1.0 / 80 : 1.0 / 480, 1e-15);
}

TEST(MassProperties, AnOpenMeshHasNone) {
    Mesh open = box(1, 1, 1, {});
    open.triangles.pop_back();
    EXPECT_THROW(mass_properties(prepare_mesh(open)), InputError);
}

TEST(MassProperties, ModelsAreCentredOnTheirVolume) {
    for (const Mesh& mesh : {knot(902), gear(902), bumpy_torus(902), bumpy_sphere(902)}) {
        const Vec3 centre = mass_properties(prepare_mesh(mesh)).centre;
        EXPECT_NEAR(centre.x, 0, 1e-7) << mesh.name;
        EXPECT_NEAR(centre.y, 0, 1e-7) << mesh.name;
        EXPECT_NEAR(centre.z, 0, 1e-7) << mesh.name;
    }
}
