// SPDX-License-Identifier: Apache-2.0
#include <scenes/ground.h>
#include <scenes/meshes_in_words.h>
#include <scenes/models/procedural.h>

#include <gtest/gtest.h>

namespace raycontact::scenes {
namespace {

SceneDescription scene_of(const std::vector<std::string>& sources) {
    SceneDescription scene;
    for (const std::string& source : sources)
        scene.shapes.push_back({Shape::make(gear(48)), bullet::Bounds::box, source});
    return scene;
}

void add(SceneDescription& scene, std::uint32_t shape, int count, double density = 1000) {
    for (int i = 0; i < count; ++i) {
        BodyStart& body = scene.bodies.emplace_back();
        body.shape = shape;
        body.density = density;
    }
}

TEST(MeshesInWords, OneMeshIsNotCounted) {
    SceneDescription scene = scene_of({"bolt.obj"});
    add_slab(scene, 10, 5); // nobody's mesh
    add(scene, 0, 512);
    EXPECT_EQ(meshes_in_words(scene), "bolt.obj");
}

TEST(MeshesInWords, SeveralAre) {
    SceneDescription scene = scene_of({"bolt.obj", "nut.obj", "unused.obj", "tray.obj"});
    add(scene, 1, 1);
    add(scene, 0, 1);
    add(scene, 3, 2, 0);
    EXPECT_EQ(meshes_in_words(scene), "1 x bolt.obj; 1 x nut.obj; standing still: 2 x tray.obj");
}

TEST(MeshesInWords, OneFileInTwoSizesHasThem) {
    SceneDescription scene = scene_of({"box.obj", "nut.obj", "box.obj"});
    for (const double size : {2.0, 0.5}) {
        Mesh mesh;
        mesh.vertices = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
        mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
        scene.shapes[size == 2 ? 0 : 2].shape = Shape::make(mesh);
    }
    for (std::uint32_t shape = 0; shape < 3; ++shape) add(scene, shape, 1);
    EXPECT_EQ(meshes_in_words(scene), "1 x box.obj, 2 m long; 1 x nut.obj; 1 x box.obj, 0.5 m long");
}

TEST(MeshesInWords, BodiesThatDoNotComeAreNot) {
    SceneDescription scene = scene_of({"bolt.obj", "nut.obj"});
    add(scene, 0, 3);
    add(scene, 1, 3);
    scene.bodies.back().step = scene.steps;
    EXPECT_EQ(meshes_in_words(scene), "3 x bolt.obj; 2 x nut.obj");
}

} // namespace
} // namespace raycontact::scenes
