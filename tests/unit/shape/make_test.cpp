// SPDX-License-Identifier: Apache-2.0
// What no shape is made of.
#include <raycontact/error.h>
#include <raycontact/shape.h>

#include "reference/meshes.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

namespace raycontact {
namespace {

TEST(MakeShape, RefusesWhatIsNoPreparedMesh) {
    const struct {
        std::function<void(PreparedMesh&)> spoil;
        std::string told;
    } cases[] = {
        {[](PreparedMesh& m) { m.triangles.clear(), m.triangle_index.clear(); }, "no triangles"},
        {[](PreparedMesh& m) { m.vertex_index.pop_back(); }, "index maps"},
        {[](PreparedMesh& m) { m.triangle_index.push_back(0); }, "index maps"},
        {[](PreparedMesh& m) { m.triangles[3][1] = 8; }, "vertex 8 does not exist"},
        {[](PreparedMesh& m) { m.vertices[5].y = std::numeric_limits<double>::quiet_NaN(); }, "vertex 5 is not finite"},
        {[](PreparedMesh& m) { m.vertices[5].y = std::numeric_limits<double>::infinity(); }, "vertex 5 is not finite"},
        {[](PreparedMesh& m) { m.vertices[5].y = 2e9; }, "1e9 m"},
        {[](PreparedMesh& m) {
             m.vertices.assign(8, {1, 2, 3});
         },
         "its box is 0 m long"},
        {[](PreparedMesh& m) {
             m.triangles.assign(12, {0, 0, 1});
         },
         "no triangle with an area"},
    };
    const PreparedMesh sound = prepare_mesh(reference::box_mesh({0.5, 0.5, 0.5}));
    ASSERT_EQ(sound.vertices.size(), 8u);
    EXPECT_NO_THROW(Shape::make(sound));
    for (const auto& [spoil, told] : cases) {
        PreparedMesh mesh = sound;
        spoil(mesh);
        try {
            Shape::make(mesh);
            ADD_FAILURE() << told;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(told), std::string::npos) << error.what();
        }
    }
}

} // namespace
} // namespace raycontact
