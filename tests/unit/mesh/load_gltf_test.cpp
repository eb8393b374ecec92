// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/mesh/formats.h"
#include "tests/unit/mesh/solids.h"

#include <raycontact/assembly.h>
#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include <gtest/gtest.h>

using namespace raycontact;
using namespace raycontact::test;

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Mesh quad() {
    return {"quad", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

std::string replaced(std::string text, const std::string& old, const std::string& with) {
    const std::size_t at = text.find(old);
    EXPECT_NE(at, std::string::npos) << old;
    return text.replace(at, old.size(), with);
}

TEST(LoadGltf, BufferInsideAndBeside) {
    const TempFolder folder;
    const Mesh made = quad();
    const std::string one = R"([{"mesh":0}])";
    const Mesh inside = load_mesh(folder.write("m.glb", as_glb(made)));
    folder.write("m.bin", gltf_buffer(made));
    const Mesh beside = load_mesh(folder.write("m.gltf", gltf_json(made, one, "m.bin")));
    folder.write("a name.bin", gltf_buffer(made));
    const Mesh spaced = load_mesh(folder.write("m.gltf", gltf_json(made, one, "a%20name.bin")));
    for (const Mesh& mesh : {inside, beside, spaced}) {
        EXPECT_EQ(mesh.vertices, made.vertices);
        EXPECT_EQ(mesh.triangles, made.triangles);
    }
}

TEST(LoadGltf, BufferFileMayBeLongerThanItsBuffer) {
    const TempFolder folder;
    const Mesh made = quad();
    const std::filesystem::path buffer = folder.write("m.bin", gltf_buffer(made));
    std::filesystem::resize_file(buffer, std::uintmax_t{1} << 40); // more than fits memory, and nearly all of it a hole
    const Mesh mesh = load_mesh(folder.write("m.gltf", gltf_json(made, R"([{"mesh":0}])", "m.bin")));
    EXPECT_EQ(mesh.vertices, made.vertices);
    EXPECT_EQ(mesh.triangles, made.triangles);
}

TEST(LoadGltf, BufferInBase64) {
    const TempFolder folder;
    // (0 0 0), (1 0 0), (0 1 0); then 0 1 2 in 16 bits: 42 bytes.
    const std::string uri =
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA";
    const std::string json =
        R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
        R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
        R"({"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],)"
        R"("bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],)"
        R"("buffers":[{"byteLength":42,"uri":")"
        + uri + R"("}]})";
    const Mesh mesh = load_mesh(folder.write("m.gltf", json));
    EXPECT_EQ(mesh.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}}));
}

TEST(LoadGltf, NodesInTheirOrderWithTransformsOfAllAncestors) {
    const TempFolder folder;
    // Node 1 hangs below 2 below 0; node 3 is in no scene.
    const std::string nodes =
        R"([{"children":[2],"translation":[10,0,0]},{"mesh":0,"scale":[2,2,2]},)"
        R"({"mesh":0,"children":[1],"rotation":[0,0,0.7071067811865476,0.7071067811865476]},{"mesh":0}])";
    const Mesh mesh = load_mesh(folder.write("m.glb", glb(gltf_json(quad(), nodes, ""), gltf_buffer(quad()))));
    ASSERT_EQ(mesh.vertices.size(), 8u);
    EXPECT_NEAR(mesh.vertices[1].x, 10, 1e-12); // node 1: (1 0 0) scaled by 2, turned a quarter about z, moved
    EXPECT_NEAR(mesh.vertices[1].y, 2, 1e-12);
    EXPECT_NEAR(mesh.vertices[5].y, 1, 1e-12); // node 2
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}}));
}

TEST(LoadGltf, MirroringNodeKeepsFrontsOutside) {
    const TempFolder folder;
    const std::string nodes = R"([{"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]}])";
    const Mesh mesh = load_mesh(folder.write("m.glb", glb(gltf_json(box(), nodes, ""), gltf_buffer(box()))));
    EXPECT_EQ(mesh.vertices[1], (Vec3{4, 0, 0}));
    const MeshReport report = prepare_mesh(mesh, Repair::as_is).report;
    EXPECT_TRUE(report.outward);
    EXPECT_NEAR(report.volume, 1, 1e-15);
}

TEST(LoadGltf, StripsFansAndNoIndices) {
    const TempFolder folder;
    const Mesh made = quad();
    const std::string json = gltf_json(made, R"([{"mesh":0}])", "");
    const auto load = [&](const std::string& changed) {
        return load_mesh(folder.write("m.glb", glb(changed, gltf_buffer(made)))).triangles;
    };
    EXPECT_EQ(load(replaced(json, R"("indices":1)", R"("mode":5)")), (Triangles{{0, 1, 2}, {1, 3, 2}}));
    EXPECT_EQ(load(replaced(json, R"("indices":1)", R"("mode":6)")), (Triangles{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_THROW(load(replaced(json, R"("indices":1)", R"("mode":1)")), InputError); // lines only
    EXPECT_THROW(load(replaced(json, R"(,"indices":1)", "")), InputError);           // 4 is no multiple of 3
}

TEST(LoadGltf, ShortIndicesAndQuantizedPositions) {
    const TempFolder folder;
    std::string buffer;
    for (const int c : {0, 0, 0, 127, 0, 0, 0, 127, 0}) put(buffer, static_cast<std::int8_t>(c));
    buffer += std::string(3, '\0');
    for (const int c : {0, 2, 1}) put(buffer, static_cast<std::uint16_t>(c));
    for (const int c : {1, 2, 0}) put(buffer, static_cast<std::uint8_t>(c));
    const std::string json =
        R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_mesh_quantization"],"nodes":[{"mesh":0}],"meshes":[{"primitives":[)"
        R"({"attributes":{"POSITION":0},"indices":1},{"attributes":{"POSITION":0},"indices":2}]}],"accessors":[)"
        R"({"bufferView":0,"componentType":5120,"normalized":true,"count":3,"type":"VEC3"},)"
        R"({"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"},{"bufferView":2,"componentType":5121,"count":3,"type":"SCALAR"}],)"
        R"("bufferViews":[{"buffer":0,"byteLength":9},{"buffer":0,"byteOffset":12,"byteLength":6},{"buffer":0,"byteOffset":18,"byteLength":3}],)"
        R"("buffers":[{"byteLength":21}]})";
    const Mesh mesh = load_mesh(folder.write("m.glb", glb(json, buffer)));
    EXPECT_EQ(mesh.vertices[1], (Vec3{1, 0, 0}));
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 2, 1}, {4, 5, 3}}));
}

TEST(LoadGltf, SparsePositions) {
    const TempFolder folder;
    std::string buffer = gltf_buffer(quad());
    const std::size_t at = buffer.size();
    put(buffer, std::uint16_t{2});
    put(buffer, std::uint16_t{0});
    for (const float c : {9.0f, 8.0f, 7.0f}) put(buffer, c);
    std::string json = gltf_json(quad(), R"([{"mesh":0}])", "");
    json = replaced(
        json, R"("count":4,)",
        R"("count":4,"sparse":{"count":1,"indices":{"bufferView":2,"componentType":5123},"values":{"bufferView":3}},)");
    json =
        replaced(json, R"(}],"buffers")",
                 R"(},{"buffer":0,"byteOffset":)" + std::to_string(at) + R"(,"byteLength":2},{"buffer":0,"byteOffset":)"
                     + std::to_string(at + 4) + R"(,"byteLength":12}],"buffers")");
    json = replaced(json, R"("buffers":[{"byteLength":)" + std::to_string(at),
                    R"("buffers":[{"byteLength":)" + std::to_string(buffer.size()));
    const Mesh mesh = load_mesh(folder.write("m.glb", glb(json, buffer)));
    EXPECT_EQ(mesh.vertices[2], (Vec3{9, 8, 7}));
    EXPECT_EQ(mesh.vertices[1], (Vec3{1, 0, 0}));
}

TEST(LoadGltf, ScalesThatDifferByRoundingAloneShareAMesh) {
    const TempFolder folder;
    std::string nodes;
    for (const double scale : {0.99999998, 1.0, 1.00000002, 0.9, 0.90000003, 0.89999997, 25.4, 0.99999}) {
        const std::string s = text(scale);
        nodes += nodes.empty() ? "[" : ",";
        nodes.append(R"({"mesh":0,"matrix":[)").append(s).append(",0,0,0, 0,0,").append(s).append(",0, 0,-");
        nodes.append(s).append(",0,0, 0,0,0,1]}");
    }
    const std::string json =
        replaced(gltf_json(quad(), nodes + "]", ""), R"({"nodes":[0]})", R"({"nodes":[0,1,2,3,4,5,6,7]})");
    const std::vector<AssemblyPart> parts = load_assembly(folder.write("m.glb", glb(json, gltf_buffer(quad()))));
    ASSERT_EQ(parts.size(), 8u);
    EXPECT_EQ(parts[0].mesh, parts[1].mesh);
    EXPECT_EQ(parts[0].mesh, parts[2].mesh);
    EXPECT_EQ(parts[0].mesh->vertices[1], (Vec3{1, 0, 0}));
    EXPECT_EQ(parts[3].mesh, parts[4].mesh);
    EXPECT_EQ(parts[3].mesh, parts[5].mesh);
    EXPECT_NEAR(parts[3].mesh->vertices[1].x, 0.9, 1e-15);
    EXPECT_NEAR(parts[6].mesh->vertices[1].x, 25.4, 1e-14);
    EXPECT_NE(parts[0].mesh, parts[7].mesh);
}

} // namespace
