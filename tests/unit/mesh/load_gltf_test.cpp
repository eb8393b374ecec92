// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/mesh/formats.h"
#include "tests/unit/mesh/solids.h"

#include <raycontact/assembly.h>
#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include <gtest/gtest.h>

#include <type_traits>

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

TEST(LoadGltf, JsonMayBeFilledWithNul) {
    const TempFolder folder;
    std::string json = gltf_json(quad(), R"([{"mesh":0}])", "");
    json.resize((json.size() / 4 + 1) * 4, '\0');
    EXPECT_EQ(load_mesh(folder.write("m.glb", glb(json, gltf_buffer(quad())))).vertices, quad().vertices);
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
    const MeshReport report = prepare_mesh(mesh, {.repair = Repair::as_is}).report;
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

/// The buffer of a GLB, and accessors of it.
struct Accessors {
    template <class T>
    void add(const std::vector<T>& numbers, std::size_t width, const std::string& more = "") {
        const std::size_t type = std::is_same_v<T, float> ? 5126 : sizeof(T) == 1 ? 5121 : 5123;
        const std::string comma = count == 0 ? "" : ",";
        views += comma + R"({"buffer":0,"byteOffset":)" + std::to_string(buffer.size()) + R"(,"byteLength":)"
                 + std::to_string(numbers.size() * sizeof(T)) + "}";
        list += comma + R"({"bufferView":)" + std::to_string(count++) + R"(,"componentType":)" + std::to_string(type)
                + R"(,"count":)" + std::to_string(numbers.size() / width) + R"(,"type":")"
                + (width == 16  ? "MAT4"
                   : width == 4 ? "VEC4"
                                : "VEC3")
                + '"' + more + "}";
        for (const T number : numbers) put(buffer, number);
        buffer.resize((buffer.size() + 3) / 4 * 4);
    }
    std::string glb(const std::string& nodes, const std::string& primitive, const std::string& more) const {
        return test::glb(R"({"asset":{"version":"2.0"},"nodes":)" + nodes + R"(,"meshes":[{"primitives":[)" + primitive
                             + "]" + more + R"(,"accessors":[)" + list + R"(],"bufferViews":[)" + views
                             + R"(],"buffers":[{"byteLength":)" + std::to_string(buffer.size()) + "}]}",
                         buffer);
    }

    std::string buffer, list, views;
    std::size_t count = 0;
};

/// A triangle under an armature of a hundredth of its size, whose second joint is 3 m above the first.
struct Skinned {
    Skinned() {
        accessors.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
        accessors.add<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, 4);
        accessors.add<float>({1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0}, 4);
        accessors.add<float>({100, 0, 0, 0, 0, 100, 0, 0, 0, 0, 100, 0, 0, 0, 0, 1,
                              100, 0, 0, 0, 0, 100, 0, 0, 0, 0, 100, 0, 0, 0, 0, 1},
                             16);
    }
    std::string glb() const { return accessors.glb(nodes, primitive, more); }

    Accessors accessors;
    std::string nodes = R"([{"name":"Armature","children":[1,2],"scale":[0.01,0.01,0.01]},{"mesh":0,"skin":0},)"
                        R"({"children":[3]},{"translation":[0,300,0]}])";
    std::string primitive = R"({"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}})";
    std::string more = R"(}],"skins":[{"joints":[2,3],"inverseBindMatrices":3}])";
};

void expect_near(const std::vector<Vec3>& found, const std::vector<Vec3>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t v = 0; v < found.size(); ++v) {
        EXPECT_NEAR(found[v].x, expected[v].x, 1e-12) << v;
        EXPECT_NEAR(found[v].y, expected[v].y, 1e-12) << v;
        EXPECT_NEAR(found[v].z, expected[v].z, 1e-12) << v;
    }
}

TEST(LoadGltf, JointsPlaceASkinnedMesh) {
    const TempFolder folder;
    Skinned file;
    const auto path = folder.write("m.glb", file.glb());
    const std::vector<Vec3> expected{{0, 0, 0}, {1, 3, 0}, {0, 2.5, 0}};
    expect_near(load_mesh(path).vertices, expected);
    const std::vector<AssemblyPart> parts = load_assembly(path);
    ASSERT_EQ(parts.size(), 1u);
    expect_near(parts[0].mesh->vertices, expected);
    EXPECT_EQ(parts[0].pose.translation, Vec3{});
    EXPECT_EQ(parts[0].name, "nodes[1]");

    // Without matrices it is not taken into the frame of the joints first.
    file.more = R"(}],"skins":[{"joints":[2,3]}])";
    expect_near(load_mesh(folder.write("m.glb", file.glb())).vertices, {{0, 0, 0}, {0.01, 3, 0}, {0, 1.51, 0}});
}

TEST(LoadGltf, PartsKnowWhatTheyAreUnder) {
    const TempFolder folder;
    const auto under = [&](const std::string& nodes) {
        folder.write("m.bin", gltf_buffer(quad()));
        std::vector<std::vector<std::string>> found;
        for (const AssemblyPart& part : load_assembly(folder.write("m.gltf", gltf_json(quad(), nodes, "m.bin"))))
            found.push_back(part.under);
        return found;
    };
    using Under = std::vector<std::vector<std::string>>;
    EXPECT_EQ(under(R"([{"name":"hall","children":[1]},{"mesh":0,"children":[2]},{"mesh":0,"name":"lid"}])"),
              (Under{{"hall"}, {"hall", "nodes[1]"}}));
    // A chain of long names: the nearest, as far as a thousand bytes reach.
    std::string chain;
    for (int i = 0; i < 50; ++i)
        chain += R"({"name":")" + std::to_string(i) + std::string(98, 'x') + R"(","children":[)" + std::to_string(i + 1)
                 + "]},";
    EXPECT_EQ(
        under(R"([{"name":"hall","children":[1,2]},{"name":"robot","children":[3]},{"name":"robot","children":[4]},)"
              R"({"mesh":0,"name":"arm"},{"mesh":0,"name":"arm"}])"),
        (Under{{"hall", "robot #1"}, {"hall", "robot #2"}}))
        << "two of one name are two";
    const Under deep = under("[" + chain + R"({"mesh":0}])");
    ASSERT_EQ(deep.size(), 1u);
    EXPECT_EQ(deep[0].size(), 10u);
    EXPECT_TRUE(deep[0].front().starts_with("40x")) << deep[0].front();
    EXPECT_TRUE(deep[0].back().starts_with("49x")) << deep[0].back();
}

TEST(LoadGltf, ASkinnedMeshUnderAScaledArmatureHasItsBindSize) {
    const TempFolder folder;
    Skinned file;
    file.nodes = replaced(file.nodes, "300", "0");
    expect_near(load_mesh(folder.write("m.glb", file.glb())).vertices, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
}

TEST(LoadGltf, JointsAndWeightsOfAllTypesAndOfTwoSets) {
    const TempFolder folder;
    Skinned file;
    file.accessors.add<std::uint16_t>({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, 4);
    file.accessors.add<std::uint8_t>({51, 204, 0, 0, 51, 204, 0, 0, 255, 0, 0, 0}, 4, R"(,"normalized":true)");
    file.accessors.add<std::uint16_t>({65535, 0, 0, 0, 0, 0, 0, 0, 0, 65535, 0, 0}, 4, R"(,"normalized":true)");
    file.primitive = R"({"attributes":{"POSITION":0,"JOINTS_0":4,"WEIGHTS_0":5}})";
    expect_near(load_mesh(folder.write("m.glb", file.glb())).vertices, {{0, 2.4, 0}, {1, 2.4, 0}, {0, 1, 0}});
    // By the sum of all weights: 2, 1 and 2.
    file.primitive = R"({"attributes":{"POSITION":0,"JOINTS_0":4,"WEIGHTS_0":5,"JOINTS_1":4,"WEIGHTS_1":6}})";
    expect_near(load_mesh(folder.write("m.glb", file.glb())).vertices, {{0, 1.2, 0}, {1, 2.4, 0}, {0, 2.5, 0}});
}

TEST(LoadGltf, MirroringJointsKeepFrontsOutside) {
    const TempFolder folder;
    Skinned file;
    const auto triangles = [&] { return load_mesh(folder.write("m.glb", file.glb())).triangles; };
    EXPECT_EQ(triangles(), (Triangles{{0, 1, 2}}));
    file.nodes = replaced(file.nodes, R"({"mesh":0,)", R"({"scale":[-1,1,1],"mesh":0,)"); // does not count
    EXPECT_EQ(triangles(), (Triangles{{0, 1, 2}}));
    file.nodes = replaced(file.nodes, "[0.01,", "[-0.01,");
    EXPECT_EQ(triangles(), (Triangles{{0, 2, 1}}));
}

TEST(LoadGltf, PartsShareAMeshIfTheyHaveItsSkinAndWeightsInCommon) {
    const TempFolder folder;
    Skinned file;
    file.nodes = replaced(file.nodes, "]}]",
                          R"(]},{"mesh":0,"skin":0,"translation":[1,1,1]},{"mesh":0},{"mesh":0,"skin":1},)"
                          R"({"mesh":0,"weights":[1]},{"mesh":0,"weights":[0]}])");
    file.primitive = replaced(file.primitive, "}}", R"(},"targets":[{"POSITION":0}]})");
    file.more = R"(,"weights":[0]}],"skins":[{"joints":[2,3],"inverseBindMatrices":3},{"joints":[2]}])";
    // Skin 1 has one joint: it would be refused where joint 1 is named.
    file.more = replaced(file.more, R"({"joints":[2]})", R"({"joints":[2,2]})");
    const std::vector<AssemblyPart> parts = load_assembly(folder.write("m.glb", file.glb()));
    ASSERT_EQ(parts.size(), 6u);
    EXPECT_EQ(parts[0].mesh, parts[1].mesh);
    EXPECT_EQ(parts[1].pose.translation, Vec3{});
    EXPECT_NE(parts[0].mesh, parts[2].mesh);
    expect_near(parts[2].mesh->vertices, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    expect_near(parts[3].mesh->vertices, {{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}});
    expect_near(parts[4].mesh->vertices, {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}});
    EXPECT_EQ(parts[2].mesh, parts[5].mesh);
}

TEST(LoadGltf, MorphTargetsByTheWeightsOfTheNodeElseOfTheMesh) {
    const TempFolder folder;
    Skinned file;
    file.accessors.add<float>({0, 0, 0, 0, 0, 1, 0, 0, 0}, 3);
    file.accessors.list += R"(,{"componentType":5126,"count":3,"type":"VEC3"})"; // moves nothing
    file.primitive = R"({"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2},)"
                     R"("targets":[{"POSITION":4},{"NORMAL":9},{"POSITION":5}]})";
    const auto expect = [&](const std::string& nodes, const std::string& mesh, const std::vector<Vec3>& expected) {
        file.nodes = nodes;
        file.more = mesh + R"(}],"skins":[{"joints":[1]}])";
        expect_near(load_mesh(folder.write("m.glb", file.glb())).vertices, expected);
    };
    expect(R"([{"mesh":0}])", "", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    expect(R"([{"mesh":0}])", R"(,"weights":[0.5,1,1])", {{0, 0, 0}, {1, 0, 0.5}, {0, 1, 0}});
    expect(R"([{"mesh":0,"weights":[2,1,1]}])", R"(,"weights":[0.5,1,1])", {{0, 0, 0}, {1, 0, 2}, {0, 1, 0}});
    // First the targets, then the joints.
    const std::string skinned = R"([{"mesh":0,"skin":0,"weights":[2,1,1]},{"scale":[3,3,3]}])";
    file.accessors.buffer.replace(36, 12, 12, '\0'); // joints: all 0
    expect(skinned, "", {{0, 0, 0}, {3, 0, 6}, {0, 3, 0}});
}

TEST(LoadGltf, SkinsAndMorphTargetsThatDoNotFitAreRefused) {
    const TempFolder folder;
    Skinned file;
    file.accessors.add<float>({0, 0, 0, 0, 0, 0}, 3);                                // 4: two of them
    file.accessors.add<float>({1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, 4);              // 5: none for vertex 2
    file.accessors.add<float>({1, 0, 0, 0, 1, 0, 0, 0, 2, -1, 0, 0}, 4);             // 6
    file.accessors.add<std::uint8_t>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4);       // 7: not normalized
    file.accessors.add<std::uint8_t>({0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0}, 4);       // 8: joint 2
    file.accessors.add<float>({1, 0, 0, 0, 1, 0, 0, 0}, 4);                          // 9: two of them
    file.accessors.add<std::uint8_t>({0, 0, 0, 0, 0, 0, 0, 0}, 4);                   // 10: two of them
    file.accessors.add<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, 16); // 11: one of them
    file.primitive = replaced(file.primitive, "}}", R"(},"targets":[{"POSITION":0}]})");
    file.nodes = replaced(file.nodes, R"("skin":0)", R"("skin":0,"weights":[1])");
    EXPECT_NO_THROW(load_mesh(folder.write("m.glb", file.glb())));
    struct Case {
        std::string Skinned::*part;
        std::string old, with, words;
    };
    const std::vector<Case> cases{
        {&Skinned::nodes, R"("skin":0)", R"("skin":1)", "skins[1] does not exist"},
        {&Skinned::nodes, R"("skin":0)", R"("skin":-1)", "nodes[1].skin: is not a whole number of at least 0"},
        {&Skinned::nodes, "[1]}", "[1,2]}", "nodes[1]: weights has not 1 numbers"},
        {&Skinned::nodes, "[1]}", "[null]}", "nodes[1]: weights has not 1 numbers"},
        {&Skinned::nodes, "[1]}", "1}", "nodes[1].weights: is no list"},
        {&Skinned::more, "[2,3]", "[2,4]", "skins[0]: node 4 does not exist"},
        {&Skinned::more, "[2,3]", "[]", "skins[0]: has no joints"},
        {&Skinned::more, ":3}", ":12}", "accessors[12] does not exist"},
        {&Skinned::more, ":3}", ":0}", "accessors[0]: is not of type MAT4"},
        {&Skinned::more, ":3}", ":7}", "accessors[7]: matrices of a skin must be float32"},
        {&Skinned::more, ":3}", ":11}", "skins[0]: has 2 joints, but accessors[11] has only 1 matrices"},
        {&Skinned::primitive, R"("JOINTS_0":1,)", "", "attributes: has no JOINTS_0"},
        {&Skinned::primitive, R"("WEIGHTS_0":2)", R"("WEIGHTS_0":2,"WEIGHTS_1":2)", "attributes: has no JOINTS_1"},
        {&Skinned::primitive, R"("JOINTS_0":1)", R"("JOINTS_0":2)",
         "accessors[2]: joints must be whole numbers of 8 or 16 bits"},
        {&Skinned::primitive, R"("JOINTS_0":1)", R"("JOINTS_0":8)",
         "accessors[8]: record 1: joint 2 is not in 0 to 2 - 1"},
        {&Skinned::primitive, R"("JOINTS_0":1)", R"("JOINTS_0":10)", "accessors[10]: has 2 records for 3 vertices"},
        {&Skinned::primitive, R"("WEIGHTS_0":2)", R"("WEIGHTS_0":0)", "accessors[0]: is not of type VEC4"},
        {&Skinned::primitive, R"("WEIGHTS_0":2)", R"("WEIGHTS_0":5)",
         "attributes: vertex 2 has no weight for any joint"},
        {&Skinned::primitive, R"("WEIGHTS_0":2)", R"("WEIGHTS_0":6)",
         "accessors[6]: record 2: a weight is not a number of at least 0"},
        {&Skinned::primitive, R"("WEIGHTS_0":2)", R"("WEIGHTS_0":7)", "accessors[7]: weights must be float32, or"},
        {&Skinned::primitive, R"("WEIGHTS_0":2)", R"("WEIGHTS_0":9)", "accessors[9]: has 2 records for 3 vertices"},
        {&Skinned::primitive, R"([{"POSITION":0}])", "[]", "nodes[1]: weights has not 0 numbers"},
        {&Skinned::primitive, R"([{"POSITION":0}])", "[0]", "primitives[0].targets[0]: is no object"},
        {&Skinned::primitive, R"([{"POSITION":0}])", R"([{"POSITION":12}])", "accessors[12] does not exist"},
        {&Skinned::primitive, R"([{"POSITION":0}])", R"([{"POSITION":4}])",
         "accessors[4]: has 2 displacements for 3 vertices"},
        {&Skinned::primitive, "]}", R"(]},{"attributes":{}})",
         "primitives[1]: has 0 morph targets, the first primitive 1"},
    };
    for (const auto& [part, old, with, words] : cases) {
        SCOPED_TRACE(with);
        Skinned changed(file);
        changed.*part = replaced(changed.*part, old, with);
        const auto path = folder.write("m.glb", changed.glb());
        for (const bool as_parts : {false, true}) {
            try {
                as_parts ? void(load_assembly(path)) : void(load_mesh(path));
                ADD_FAILURE() << "no error; expected " << words;
            } catch (const InputError& error) {
                EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
            }
        }
    }
}

TEST(LoadGltf, MorphTargetsAreNotAppliedWithoutEnd) {
    const TempFolder folder;
    Skinned file;
    // Ten thousand nodes with ten thousand targets each.
    file.primitive = R"({"attributes":{"POSITION":0},"targets":[{"POSITION":0})";
    file.more = R"(,"weights":[1)";
    file.nodes = R"([{"mesh":0})";
    for (int i = 1; i < 10000; ++i) {
        file.primitive += R"(,{"POSITION":0})";
        file.more += ",1";
        file.nodes += R"(,{"mesh":0})";
    }
    file.primitive += "]}";
    file.more += "]}]";
    file.nodes += "]";
    EXPECT_THROW(load_mesh(folder.write("m.glb", file.glb())), InputError);
}

/// Three instances of a triangle under a moved node.
struct Instanced {
    Instanced() {
        accessors.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
        accessors.add<float>({0, 0, 0, 10, 0, 0, 0, 20, 0}, 3);
        accessors.add<float>({0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 1}, 4);
        accessors.add<float>({1, 1, 1, 1, 1, 1, 2, 2, 2}, 3);
    }
    std::string glb() const {
        return accessors.glb(
            R"([{"name":"tree","mesh":0,"translation":[0,0,5],"extensions":{"EXT_mesh_gpu_instancing":)"
            R"({"attributes":)"
                + attributes + R"(}},"children":[1]},{"mesh":0}])",
            R"({"attributes":{"POSITION":0}})", "}]" + more);
    }

    Accessors accessors;
    std::string attributes = R"({"TRANSLATION":1,"ROTATION":2,"SCALE":3,"_ID":0})", more;
};

TEST(LoadGltf, InstancesAreExpanded) {
    const TempFolder folder;
    Instanced file;
    file.more = R"(,"extensionsUsed":["EXT_mesh_gpu_instancing"],"extensionsRequired":["EXT_mesh_gpu_instancing"])";
    const auto path = folder.write("m.glb", file.glb());
    // As it is; a half turn about z; twice as large. The child is there once.
    const Mesh mesh = load_mesh(path);
    expect_near(mesh.vertices, {{0, 0, 5},
                                {1, 0, 5},
                                {0, 1, 5},
                                {10, 0, 5},
                                {9, 0, 5},
                                {10, -1, 5},
                                {0, 20, 5},
                                {2, 20, 5},
                                {0, 22, 5},
                                {0, 0, 5},
                                {1, 0, 5},
                                {0, 1, 5}});
    EXPECT_EQ(mesh.repairs, std::vector<std::string>());
    const std::vector<AssemblyPart> parts = load_assembly(path);
    ASSERT_EQ(parts.size(), 4u);
    EXPECT_EQ(parts[0].name, "tree[0]");
    EXPECT_EQ(parts[2].name, "tree[2]");
    EXPECT_EQ(parts[3].name, "nodes[1]");
    EXPECT_EQ(parts[0].mesh, parts[1].mesh);
    EXPECT_EQ(parts[0].mesh, parts[3].mesh);
    EXPECT_EQ(parts[1].pose.translation, (Vec3{10, 0, 5}));
    EXPECT_EQ(parts[2].mesh->vertices[1], (Vec3{2, 0, 0}));

    const auto expect = [&](const std::string& attributes, const std::string& words) {
        file.attributes = attributes;
        try {
            load_mesh(folder.write("m.glb", file.glb()));
            ADD_FAILURE() << words;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    };
    file.accessors.add<float>({0, 0, 0}, 3);
    expect(R"({"TRANSLATION":1,"SCALE":4})", "accessors[4]: has not as many instances as the others");
    expect(R"({"_ID":1})", "has no TRANSLATION, ROTATION or SCALE");
    expect(R"({"TRANSLATION":2})", "accessors[2]: is not of type VEC3");
    expect(R"({"ROTATION":9})", "accessors[9] does not exist");
    expect("[]", "attributes: is no object");
}

TEST(LoadGltf, WhatIsLeftOutIsNamed) {
    const TempFolder folder;
    // Hidden with its child, seen, a lower level, a line beside triangles, and one of no scene.
    const std::string nodes =
        R"([{"name":"lid","mesh":0,"children":[1],"extensions":{"KHR_node_visibility":{"visible":false}}},)"
        R"({"name":"bolt","mesh":0},{"name":"fine","mesh":0,"extensions":{"KHR_node_visibility":{"visible":true},)"
        R"("MSFT_lod":{"ids":[3]}}},{"name":"coarse","mesh":0},{"name":"wire","mesh":1},{"name":"spare","mesh":0}])";
    std::string json = gltf_json(quad(), nodes, "");
    json = replaced(json, R"("nodes":[0])", R"("nodes":[0,2,3,4])");
    json = replaced(json, R"(}],"accessors")",
                    R"(},{"primitives":[{"attributes":{"POSITION":0},"mode":1}]}],"accessors")");
    json =
        replaced(json, R"({"asset")",
                 R"({"extensionsUsed":["KHR_node_visibility","MSFT_lod","KHR_texture_transform","KHR_materials_unlit",)"
                 R"("KHR_draco_mesh_compression","KHR_mesh_quantization","AGI_articulations"],"asset")");
    const auto path = folder.write("m.glb", glb(json, gltf_buffer(quad())));
    const std::vector<std::string> expected{
        "left out 'lid', 'bolt': hidden (KHR_node_visibility)", "left out 'coarse': lower levels of detail (MSFT_lod)",
        "left out 'spare': not in the scene", "left out 'wire': points, lines or no positions",
        "left out what the extension 'AGI_articulations' moves or adds; it is not read"};
    const Mesh mesh = load_mesh(path);
    EXPECT_EQ(mesh.vertices, quad().vertices);
    EXPECT_EQ(mesh.repairs, expected);
    std::vector<std::string> left_out;
    const std::vector<AssemblyPart> parts = load_assembly(path, &left_out);
    ASSERT_EQ(parts.size(), 1u);
    EXPECT_EQ(parts[0].name, "fine");
    EXPECT_EQ(left_out, expected);
    // Where nothing is left the error says why.
    for (const bool as_parts : {false, true}) {
        const auto hidden = folder.write("m.glb", glb(replaced(json, "[0,2,3,4]", "[0]"), gltf_buffer(quad())));
        try {
            as_parts ? void(load_assembly(hidden)) : void(load_mesh(hidden));
            ADD_FAILURE();
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("no triangles (left out 'lid', 'bolt': hidden"), std::string::npos)
                << error.what();
        }
    }
    const std::string required = replaced(json, R"("asset")", R"("extensionsRequired":["AGI_articulations"],"asset")");
    EXPECT_THROW(load_mesh(folder.write("m.glb", glb(required, gltf_buffer(quad())))), InputError);
}

TEST(LoadGltf, ACentreOfItsOwnMovesTheScene) {
    const TempFolder folder;
    const std::string nodes = R"([{"rotation":[0,0,1,0],"children":[1]},{"mesh":0}])";
    const std::string json = replaced(gltf_json(quad(), nodes, ""), R"({"asset")",
                                      R"({"extensionsUsed":["CESIUM_RTC"],"extensionsRequired":["CESIUM_RTC"],)"
                                      R"("extensions":{"CESIUM_RTC":{"center":[6378137.25,-1e6,7]}},"asset")");
    const auto path = folder.write("m.glb", glb(json, gltf_buffer(quad())));
    EXPECT_EQ(load_mesh(path).vertices[1], (Vec3{6378136.25, -1e6, 7}));
    EXPECT_EQ(load_assembly(path)[0].pose.translation, (Vec3{6378137.25, -1e6, 7}));
    EXPECT_THROW(load_mesh(folder.write("m.glb", glb(replaced(json, ",7]", "]"), gltf_buffer(quad())))), InputError);
}

} // namespace
