// SPDX-License-Identifier: Apache-2.0
// The reader of OBJ beside another one.
#include "tests/unit/mesh/formats.h"
#include "tests/unit/mesh/solids.h"

#include <raycontact/mesh.h>

#include <gtest/gtest.h>
#include <tiny_obj_loader.h>

using namespace raycontact;
using namespace raycontact::test;

TEST(Load, ObjAgreesWithTinyobjloader) {
    const TempFolder folder;
    Mesh made = torus(7, 5, 1.1, 0.3);
    made.vertices[3].x = 1.0 / 3; // float32 cannot hold it
    const Mesh loaded = load_mesh(folder.write("m.obj", as_obj(made)));
    tinyobj::ObjReader reader;
    ASSERT_TRUE(reader.ParseFromString(as_obj(made), ""));
    const std::vector<tinyobj::real_t>& points = reader.GetAttrib().vertices;
    ASSERT_EQ(points.size(), 3 * loaded.vertices.size());
    for (std::size_t i = 0; i < loaded.vertices.size(); ++i) EXPECT_NEAR(points[3 * i], loaded.vertices[i].x, 1e-14);
    ASSERT_EQ(reader.GetShapes().size(), 1u);
    const auto& indices = reader.GetShapes()[0].mesh.indices;
    ASSERT_EQ(indices.size(), 3 * loaded.triangles.size());
    for (std::size_t i = 0; i < indices.size(); ++i) {
        EXPECT_EQ(static_cast<std::uint32_t>(indices[i].vertex_index), loaded.triangles[i / 3][i % 3]);
    }
}
