// SPDX-License-Identifier: Apache-2.0
#include "reference/meshes.h"

#include <raycontact/shape.h>

#include <gtest/gtest.h>
#include <map>
#include <tuple>

namespace raycontact {
namespace {

// As an STL file has it: every triangle with corners of its own.
Mesh unwelded(const Mesh& mesh) {
    Mesh soup;
    for (const auto& triangle : mesh.triangles) {
        const auto first = static_cast<std::uint32_t>(soup.vertices.size());
        for (const std::uint32_t v : triangle) soup.vertices.push_back(mesh.vertices[v]);
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    return soup;
}

std::map<std::tuple<double, double, double>, float> by_place(const Shape& shape) {
    std::map<std::tuple<double, double, double>, float> areas;
    for (std::size_t v = 0; v < shape.vertices().size(); ++v) {
        const Vec3& at = shape.vertices()[v];
        areas[{at.x, at.y, at.z}] = shape.vertex_areas()[v];
    }
    return areas;
}

TEST(VertexAreas, OfATetrahedronAreKnown) {
    // Three right-angled faces of 1/2, 1 and 1 m^2 meet at the origin; the fourth has half of |(1, 0, -2) x (0, 1,
    // -2)|.
    Mesh corner;
    corner.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 2}};
    corner.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    const auto shape = Shape::make(corner);
    const auto areas = shape->vertex_areas();
    ASSERT_EQ(areas.size(), 4u);
    EXPECT_EQ(areas[0], static_cast<float>(2.5 / 3));
    EXPECT_EQ(areas[1], static_cast<float>((0.5 + 1 + 1.5) / 3));
    EXPECT_EQ(areas[2], static_cast<float>((0.5 + 1 + 1.5) / 3));
    EXPECT_EQ(areas[3], static_cast<float>((1 + 1 + 1.5) / 3));
}

TEST(VertexAreas, AreThoseOfTheWeldedMesh) {
    for (const Mesh& mesh : {reference::box_mesh({1, 2, 3}), reference::bumpy_octahedron_mesh(6)}) {
        const auto shape = Shape::make(mesh), soup = Shape::make(unwelded(mesh));
        ASSERT_EQ(soup->vertices().size(), mesh.vertices.size());
        EXPECT_EQ(by_place(*shape), by_place(*soup));
    }
}

TEST(VertexAreas, GrowWithTheSquareOfTheScale) {
    const Mesh mesh = reference::bumpy_octahedron_mesh(6);
    Mesh large = mesh;
    for (Vec3& v : large.vertices) v = {4 * v.x, 4 * v.y, 4 * v.z};
    const auto shape = Shape::make(mesh), scaled = Shape::make(large);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        EXPECT_EQ(scaled->vertex_areas()[v], 16 * shape->vertex_areas()[v]) << v;
}

} // namespace
} // namespace raycontact
