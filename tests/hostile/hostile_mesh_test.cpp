// SPDX-License-Identifier: Apache-2.0
// Damaged and hostile mesh files: each gives one clear line that names the file, never garbage, a crash or a long wait.
#include "tests/unit/mesh/formats.h"
#include "tests/unit/mesh/solids.h"

#include <raycontact/error.h>
#include <raycontact/mesh.h>
#include <raycontact/scene.h>
#include <raycontact/shape.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace raycontact;
using namespace raycontact::test;

namespace {

/// What the error says; fails the test when there is none, or it is not one line naming the file.
std::string refused(const std::filesystem::path& file) {
    try {
        prepare_mesh(load_mesh(file));
    } catch (const InputError& error) {
        std::string line = error.what();
        EXPECT_EQ(line.find_first_of("\n\r"), std::string::npos) << line;
        EXPECT_NE(line.find(file.filename().string()), std::string::npos) << line;
        EXPECT_LT(line.size(), 400u) << line;
        return line;
    } catch (const std::exception& other) {
        ADD_FAILURE() << file << ": not an InputError: " << other.what();
        return {};
    }
    ADD_FAILURE() << file << " was taken as a mesh";
    return {};
}

std::string replaced(std::string text, const std::string& old, const std::string& with) {
    const std::size_t at = text.find(old);
    EXPECT_NE(at, std::string::npos) << old;
    return text.replace(at, old.size(), with);
}

Mesh sound() {
    return torus(6, 4, 1, 0.3);
}

Mesh with_coordinate(double value) {
    Mesh mesh = sound();
    mesh.vertices[5].y = value;
    return mesh;
}

Mesh with_index(std::uint32_t index) {
    Mesh mesh = sound();
    mesh.triangles[3][1] = index;
    return mesh;
}

// A sanitizer needs address space of its own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

Mesh scaled(Mesh mesh, double size) {
    for (Vec3& v : mesh.vertices) v = {v.x * size, v.y * size, v.z * size};
    return mesh;
}

struct Writer {
    const char* ending;
    std::string (*write)(const Mesh&);
};

std::string little_ply(const Mesh& mesh) {
    return as_binary_ply(mesh, false);
}
std::string big_ply(const Mesh& mesh) {
    return as_binary_ply(mesh, true);
}

const std::vector<Writer> writers{{"a.obj", &as_obj},        {"a.off", &as_off},       {"a.stl", &as_ascii_stl},
                                  {"b.stl", &as_binary_stl}, {"a.ply", &as_ascii_ply}, {"l.ply", &little_ply},
                                  {"b.ply", &big_ply},       {"a.glb", &as_glb}};

TEST(HostileMesh, TruncatedAnywhere) {
    const TempFolder folder;
    for (const Writer& writer : writers) {
        const std::string whole = writer.write(sound());
        for (std::size_t part = 1; part < 40; ++part) {
            const std::size_t size = part < 20 ? whole.size() * part / 20 : part - 20;
            if (size >= whole.size() - 4) continue;
            std::string cut = whole.substr(0, size);
            // OBJ has no end mark: cut between lines it is a smaller mesh, sound or not; cut in a face it may be, too.
            if (std::string_view(writer.ending) == "a.obj" && cut.find("\nf ") != std::string::npos) continue;
            refused(folder.write(writer.ending, cut));
        }
    }
}

TEST(HostileMesh, CoordinatesThatAreNotFinite) {
    const TempFolder folder;
    for (const Writer& writer : writers) {
        for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                                 -std::numeric_limits<double>::infinity()}) {
            refused(folder.write(writer.ending, writer.write(with_coordinate(bad))));
        }
        refused(
            folder.write(writer.ending, writer.write(with_coordinate(1e30)))); // finite, and beyond float32 arithmetic
    }
    refused(folder.write("e.obj", "v 0 0 0\nv 1e999 0 0\nv 0 1 0\nf 1 2 3\n"));
}

// Below some 1e-13 m contacts vanished without a word, and below 1e-37 m no grid could be made.
TEST(HostileMesh, SmallerThanRaysCanTell) {
    const TempFolder folder;
    for (const Writer& writer : writers) {
        for (const double size : {1e-7, 1e-13, 1e-37}) {
            const std::string error = refused(folder.write(writer.ending, writer.write(scaled(sound(), size))));
            EXPECT_NE(error.find("m long, less than the 1e-06 m"), std::string::npos) << error;
        }
    }
    for (const double size : {1e-7, 1e-42, 1e30}) {
        PreparedMesh mesh = prepare_mesh(sound());
        for (Vec3& v : mesh.vertices) v = {v.x * size, v.y * size, v.z * size};
        EXPECT_THROW(Shape::make(mesh), InputError) << size;
    }
}

TEST(HostileMesh, TheLeastSizeHasTheContactsOfAnyOther) {
    std::vector<std::size_t> counts;
    for (const double size : {1.0, std::ldexp(1.0, -21)}) { // the box is 2.6 times as long
        Scene scene;
        const auto shape = Shape::make(scaled(torus(60, 40, 1, 0.3), size));
        scene.add(shape);
        scene.add(shape, {.translation = {0.4 * size, 0.1 * size, 0.2 * size}});
        counts.push_back(scene.find_contacts().size());
    }
    EXPECT_GT(counts[0], 100u);
    EXPECT_EQ(counts[0], counts[1]);
}

TEST(HostileMesh, IndicesOutOfRange) {
    const TempFolder folder;
    for (const Writer& writer : writers) {
        if (std::string_view(writer.ending).substr(1) == ".stl") continue; // has none
        for (const std::uint32_t bad : {24u, 0x7fffffffu, 0xfffffffeu, 0xffffffffu}) {
            refused(folder.write(writer.ending, writer.write(with_index(bad))));
        }
    }
}

TEST(HostileMesh, NoTriangles) {
    const TempFolder folder;
    const Mesh points{"points", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}};
    for (const Writer& writer : writers) refused(folder.write(writer.ending, writer.write(points)));
    for (const Writer& writer : writers) refused(folder.write(writer.ending, ""));
    for (const Writer& writer : writers) refused(folder.write(writer.ending, std::string(3000, '\0')));
    for (const Writer& writer : writers)
        refused(folder.write(writer.ending, "<html><body>404 Not Found</body></html>\n"));
    const Mesh flat{"flat", {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}}};
    for (const Writer& writer : writers) refused(folder.write(writer.ending, writer.write(flat)));
}

TEST(HostileMesh, Obj) {
    const TempFolder folder;
    const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const std::vector<std::string> tails{"f 0 1 2\n",
                                         "f -4 -2 -1\n",
                                         "f 1\n",
                                         "f 1 2\n",
                                         "f 1 2 x\n",
                                         "f 1 2 3.5\n",
                                         "f 1 2 99999999999999999999\n",
                                         "f 1 2 -9223372036854775808\n",
                                         "f 1/ 2/y 3\n",
                                         "f 1//z 2 3\n",
                                         "w 1 2 3\nf 1 2 3\n",
                                         "v 1 2\nf 1 2 3\n",
                                         "v 1 2 3 4 5 6 7 8 9\nf 1 2 3\n",
                                         "f\n",
                                         "v 0x10 0 0\nf 1 2 3\n",
                                         "l 1 2 3\np 1\n",
                                         "v - 0 0\nf 1 2 3",
                                         "v +-1 0 0\nf 1 2 3",
                                         "f 1 2 \\"};
    for (const std::string& tail : tails) refused(folder.write("t.obj", three + tail));
    refused(folder.write("z.obj", three + std::string("f 1 2 3\n\0\0\0\0f 1 2 3\n", 20)));
}

TEST(HostileMesh, Stl) {
    const TempFolder folder;
    std::string counted = as_binary_stl(sound());
    counted.replace(80, 4, "\xff\xff\xff\x7f");
    EXPECT_NE(refused(folder.write("huge.stl", counted)).find("huge.stl"), std::string::npos);
    refused(folder.write("mixed.stl", as_ascii_stl(sound()) + as_binary_stl(sound())));
    refused(folder.write("mixed2.stl", as_ascii_stl(sound()).substr(0, 200) + as_binary_stl(sound()).substr(84)));
    refused(folder.write("four.stl", replaced(as_ascii_stl(sound()), "endloop", "vertex 0 0 0\nendloop")));
    refused(folder.write("two.stl", replaced(as_ascii_stl(sound()), "  vertex ", "  vertices ")));
    refused(folder.write("missing.stl", replaced(as_ascii_stl(sound()), "endfacet", "")));
    refused(folder.write("after.stl", as_ascii_stl(sound()) + "and more\n"));
}

TEST(HostileMesh, Ply) {
    const TempFolder folder;
    const std::string ascii = as_ascii_ply(sound()), binary = as_binary_ply(sound());
    for (const std::string& file : {ascii, binary}) {
        for (const auto& [old, with] : std::vector<std::pair<std::string, std::string>>{
                 {"vertex 24", "vertex 99999999999"},
                 {"vertex 24", "vertex -1"},
                 {"vertex 24", "vertex 18446744073709551617"},
                 {"vertex 24", "vertex many"},
                 {"face 48", "face 4000000000"},
                 {"face 48", "face 49"},
                 {"face 48", "face 47"},
                 {"uchar int", "float int"},
                 {"uchar int", "uchar float"},
                 {"uchar int", "uchar quad"},
                 {"property double y\n", ""},
                 {"vertex_indices", "corners"},
                 {"element vertex", "element points"},
                 {"1.0\n", "1.0\nproperty int i\n"},
                 {"end_header", "end_heading"},
                 {"format ", "formats "},
                 {"format ", "format very_"},
                 {"element face", "element vertex"},
                 {"element face", "element empty 4000000000\nelement face"}}) {
            SCOPED_TRACE(with);
            refused(folder.write("t.ply", replaced(file, old, with)));
        }
    }
    refused(folder.write("list.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list uint "
                                     "double w\nend_header\n\xff\xff\xff\xff"));
    refused(folder.write("face.ply",
                         "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\nproperty int z\n"
                         "element face 1\nproperty list uint int vertex_index\nend_header\n0 0 0\n4294967295 0 0 0\n"));
    refused(folder.write("point.ply", replaced(ascii, "3 0 4 5", "1 0")));
    const std::string strips = replaced(ascii, "element face 48", "element tristrips 48");
    EXPECT_NO_THROW(load_mesh(folder.write("strips.ply", strips)));
    for (const char* with : {"3 0 4 24", "3 0 4 -2", "3 0 4 x", "4000000000 0 4 5", "-1 0 4 5", "400 0 4 5"}) {
        SCOPED_TRACE(with);
        refused(folder.write("strips.ply", replaced(strips, "3 0 4 5", with)));
    }
}

TEST(HostileMesh, PlyHeaderLinesThatMayBeALostProperty) {
    const TempFolder folder;
    for (const std::string& file : {as_ascii_ply(sound()), as_binary_ply(sound())}) {
        refused(folder.write("t.ply", replaced(file, "property double z", "propertly double z")));
        refused(folder.write("t.ply", replaced(file, "element face", "Created by\nelement face")));
        refused(folder.write("t.ply", file.substr(0, file.find("end_header") + 10)));
        std::string alone = file.substr(0, file.find("end_header") + 11);
        std::ranges::replace(alone, '\n', '\r');
        refused(folder.write("t.ply", alone));
        refused(folder.write("t.ply", "ply\r"));
        refused(folder.write("t.ply", "ply\rend_header"));
    }
}

TEST(HostileMesh, Utf16) {
    const TempFolder folder;
    for (const char* name : {"t.obj", "t.off", "t.ply", "t.stl"}) {
        for (const std::string& text : {std::string("\xff\xfe"), std::string("\xfe\xff"), std::string("\xff\xfe\0", 3),
                                        std::string("\xff\xfe\xd8\xd8", 4), std::string("\xfe\xff\xd8\0\0f", 6)})
            refused(folder.write(name, text));
    }
}

TEST(HostileMesh, Off) {
    const TempFolder folder;
    const std::string file = as_off(sound());
    for (const auto& [old, with] :
         std::vector<std::pair<std::string, std::string>>{{"24 48", "24 4000000000"},
                                                          {"24 48", "99999999999999999999 48"},
                                                          {"24 48", "-24 48"},
                                                          {"24 48", "24"},
                                                          {"24 48", "24 49"},
                                                          {"24 48", "24 47"},
                                                          {"24 48", "25 48"},
                                                          {"OFF", "4OFF"},
                                                          {"OFF", "OFF BINARY"},
                                                          {"OFF", "nOFF"},
                                                          {"OFF", "COUGH"},
                                                          {"3 0 4 5", "4000000000 0 4 5"},
                                                          {"3 0 4 5", "1 0"},
                                                          {"3 0 4 5", "2 0 24"},
                                                          {"3 0 4 5", "3 0 -4 5"},
                                                          {"3 0 4 5", "3 0 4"},
                                                          {"3 0 4 5", "3 0 4 5e0"}}) {
        SCOPED_TRACE(with);
        refused(folder.write("t.off", replaced(file, old, with)));
    }
}

TEST(HostileMesh, Gltf) {
    const TempFolder folder;
    const std::string json = gltf_json(sound(), R"([{"mesh":0}])", ""), buffer = gltf_buffer(sound());
    for (const auto& [old, with] : std::vector<std::pair<std::string, std::string>>{
             {R"([{"mesh":0}])", R"([{"mesh":0,"children":[0]}])"},
             {R"([{"mesh":0}])", R"([{"mesh":0,"children":[1]},{"children":[2]},{"children":[1]}])"},
             {R"([{"mesh":0}])", R"([{"children":[1]},{"children":[0],"mesh":0}])"},
             {R"([{"mesh":0}])", R"([{"mesh":0,"children":[7]}])"},
             {R"([{"mesh":0}])", R"([{"mesh":0,"children":[-7]}])"},
             {R"([{"mesh":0}])", R"([{"mesh":3}])"},
             {R"([{"mesh":0}])", R"([{"mesh":0,"scale":[1,2]}])"},
             {R"([{"mesh":0}])", R"([{"mesh":0,"rotation":[0,0,0,0]}])"},
             {R"([{"mesh":0}])", R"([{"mesh":0,"scale":[1e308,1e308,1e308],"children":[]}])"},
             {R"([{"mesh":0}])", R"([{"mesh":0,"matrix":[1,2,3]}])"},
             {R"([{"mesh":0}])", R"([])"},
             {R"("nodes":[0])", R"("nodes":[1])"},
             {R"("scene":0)", R"("scene":5)"},
             {R"("POSITION":0)", R"("POSITION":9)"},
             {R"("POSITION":0)", R"("POSITION":-2)"},
             {R"("POSITION":0)", R"("COLOR_0":0)"},
             {R"("indices":1)", R"("indices":0)"},
             {R"("indices":1)", R"("indices":77)"},
             {R"("indices":1)", R"("indices":-1)"},
             {R"("indices":1)", R"("indices":"1")"},
             {R"("indices":1)", R"("indices":1.5)"},
             {R"("indices":1)", R"("indices":1,"mode":0)"},
             {R"("count":24)", R"("count":25)"},
             {R"("count":24)", R"("count":18446744073709551615)"},
             {R"("count":24)", R"("count":-1)"},
             {R"("count":144)", R"("count":4000000000)"},
             {R"("count":144)", R"("count":143)"},
             {R"("componentType":5126)", R"("componentType":1)"},
             {R"("componentType":5126)", R"("componentType":5130)"},
             {R"("VEC3")", R"("VEC2")"},
             {R"("VEC3")", R"("MAT4")"},
             {R"("bufferView":0)", R"("bufferView":8)"},
             {R"("bufferView":0,)", R"("count":4000000000000,)"},
             {R"("bufferView":0,)", R"("bufferView":0,"byteOffset":18446744073709551000,)"},
             {R"({"buffer":0,)", R"({"buffer":6,)"},
             {R"({"buffer":0,)", R"({"byteStride":4,"buffer":0,)"},
             {R"("byteOffset":0)", R"("byteOffset":1000000)"},
             {R"("byteOffset":0)", R"("byteOffset":-8)"},
             {R"("byteLength":288)", R"("byteLength":18446744073709551610)"},
             {R"("asset")", R"("extensionsRequired":["KHR_draco_mesh_compression"],"asset")"},
             {R"("version":"2.0")", R"("version":2)"},
             {R"({"asset")", R"(["asset")"}}) {
        SCOPED_TRACE(with);
        refused(folder.write("t.glb", glb(replaced(json, old, with), buffer)));
    }
    refused(folder.write("short.glb", glb(json, buffer.substr(0, 100))));
    std::string sized = as_glb(sound());
    refused(folder.write("chunk.glb", sized.replace(12, 4, "\xff\xff\xff\x7f")));
    refused(folder.write("missing.gltf", gltf_json(sound(), R"([{"mesh":0}])", "not-there.bin")));
    refused(folder.write("folder.gltf", gltf_json(sound(), R"([{"mesh":0}])", "..")));
    refused(folder.write("endless.gltf", gltf_json(sound(), R"([{"mesh":0}])", "../../../../../../dev/zero")));
    refused(folder.write("base64.gltf",
                         gltf_json(sound(), R"([{"mesh":0}])", "data:application/octet-stream;base64,AAAA")));
    refused(folder.write("deep.gltf", std::string(200000, '[')));
    refused(folder.write("deeper.gltf", R"({"asset":{"version":"2.0","extras":)" + std::string(50000, '[')));
}

TEST(HostileMesh, GltfErrorsSayWhatIsWrongAndWhere) {
    struct Case {
        const char *old, *with, *words;
    };
    const std::vector<Case> cases{
        {R"({"asset")", R"({"x":1e999,"asset")", "a number of its JSON is too large"},
        // A null is not taken for a missing value.
        {R"("indices":1)", R"("indices":null)", "meshes[0].primitives[0].indices: is not a whole number"},
        {R"("byteOffset":0)", R"("byteOffset":null)", "bufferViews[0].byteOffset: is not a whole number"},
        {R"("bufferView":0)", R"("bufferView":null)", "accessors[0].bufferView: is not a whole number"},
        {R"("POSITION":0)", R"("POSITION":null)", "primitives[0].attributes.POSITION: is not a whole number"},
        {R"([{"mesh":0}])", R"([{"mesh":0},{"mesh":null}])", "nodes[1].mesh: is not a whole number"},
        {R"([{"mesh":0}])", R"([{"mesh":0,"scale":null}])", "nodes[0].scale: is no list"},
        {R"([{"mesh":0}])", R"([{"mesh":0,"scale":[]}])", "nodes[0]: scale has not 3 numbers"},
        {R"("scene":0)", R"("scene":null)", "scene: is not a whole number"},
        {R"("scene":0,"scenes":[{"nodes":[0]}])", R"("scene":0)", "scenes[0] does not exist"},
        // Indices.
        {R"("count":144)", R"("count":144,"normalized":true)", "accessors[1]: indices must not be normalized"},
        {R"("componentType":5125)", R"("componentType":5120)", "accessors[1]: component type 5120: indices must be"},
        {R"("componentType":5125)", R"("componentType":5122)", "accessors[1]: component type 5122: indices must be"},
        {R"("componentType":5125)", R"("componentType":5126)", "accessors[1]: component type 5126: indices must be"},
        // Records without data.
        {R"("bufferView":1,)", "", "accessors[1]: has neither a bufferView nor sparse records"},
        {R"("bufferView":0,)", "", "accessors[0]: has neither a bufferView nor sparse records"},
        {R"("bufferView":0,"componentType":5126,"count":24)",
         R"("sparse":{"count":0,"indices":{"bufferView":1,"componentType":5125},"values":{"bufferView":0}},)"
         R"("componentType":5126,"count":16000000)",
         "accessors[0]: has more records than the file has bytes"},
        {R"("count":24)",
         R"("sparse":{"count":25,"indices":{"bufferView":1,"componentType":5125},"values":{"bufferView":1}},)"
         R"("count":24)",
         "accessors[0].sparse: replaces more records than its accessor has"},
        {R"("count":24)",
         R"("sparse":{"count":1,"indices":{"bufferView":1,"componentType":5126},"values":{"bufferView":0}},)"
         R"("count":24)",
         "accessors[0].sparse.indices: component type 5126: indices must be"},
        {R"("count":24)", R"("count":24,"sparse":[])", "accessors[0].sparse: is no object"},
        // Values of the wrong kind.
        {R"([{"mesh":0}])", R"([{"mesh":0},7])", "nodes[1]: is no object"},
        {R"("meshes":[)", R"("meshes":[{"primitives":[]},[],)", "meshes[1]: is no object"},
        {R"("indices":1})", R"("indices":1},5)", "meshes[0].primitives[1]: is no object"},
        {R"("indices":1})", R"("indices":1},{})", "meshes[0].primitives[1]: has no attributes"},
        {R"({"POSITION":0})", "[0]", "meshes[0].primitives[0].attributes: is no object"},
        {R"("indices":1)", R"("indices":1,"mode":9)", "meshes[0].primitives[0]: mode 9 is not in 0 to 6"},
        {R"("count":24)", R"("count":24,"normalized":1)", "accessors[0].normalized: is neither true nor false"},
        {R"("count":24,"type":"VEC3")", R"("count":24,"type":3)", "accessors[0].type: is no text"},
        {R"("count":24,)", "", "accessors[0]: has no count"},
        {R"({"byteLength":864)", R"({"uri":7,"byteLength":864)", "buffers[0].uri: is no text"},
        {R"([{"byteLength":864})", R"([{"byteLength":864},{"byteLength":0})", "buffers[1] has no uri"},
        {R"({"byteLength":864)", R"({"uri":"data:,AAAA","byteLength":864)", "'data:,AAAA' is no base64"},
        {R"({"byteLength":864)", R"({"uri":"data:;base64","byteLength":864)", "'data:;base64' is no base64"},
        {R"({"byteLength":864)", R"({"uri":"data:;base64,AAAA","byteLength":864)", "buffers[0]: has 3 bytes of 864"}};
    const TempFolder folder;
    const std::string json = gltf_json(sound(), R"([{"mesh":0}])", ""), buffer = gltf_buffer(sound());
    const auto expect = [](const std::string& error, const std::string& words) {
        EXPECT_NE(error.find(words), std::string::npos) << error << "\nlacks: " << words;
    };
    for (const auto& [old, with, words] : cases)
        expect(refused(folder.write("t.glb", glb(replaced(json, old, with), buffer))), words);
    expect(refused(folder.write("t.gltf", json)), "buffers[0] has no uri");
    expect(refused(folder.write("t.glb", as_glb(sound()).replace(4, 1, "\1"))), "is of glTF 1.0");
    expect(refused(folder.write("t.glb", as_glb(sound()).replace(10, 1, "\1"))),
           "fewer bytes than its GLB header says");
    expect(refused(folder.write("t.glb", "glTF")), "fewer bytes than its GLB header says");
}

TEST(HostileMesh, GltfOfAnotherKindIsCalledByItsName) {
    const TempFolder folder;
    const std::string json = gltf_json(sound(), R"([{"mesh":0}])", ""), buffer = gltf_buffer(sound());
    struct Case {
        const char *old, *with, *words;
    };
    const std::vector<Case> cases{
        {R"({"asset")", R"({"extensionsRequired":["KHR_draco_mesh_compression"],"asset")", "compressed with Draco"},
        {R"("indices":1})", R"("indices":1,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0}}})", nullptr},
        {R"("bufferView":0,)", "", "neither a bufferView"},
        {R"({"asset")", R"({"extensionsRequired":["EXT_meshopt_compression"],"asset")", "compressed with meshopt"},
        {R"({"asset")", R"({"extensionsRequired":["KHR_meshopt_compression"],"asset")", "compressed with meshopt"},
        {R"("2.0")", R"("1.0")", "of glTF 1.0"},
        {R"("2.0")", R"("1.1")", "of glTF 1.0"},
        {R"("2.0")", "1.0", "of glTF 1.0"},
        {R"("2.0")", R"("3.0")", "version is 2"}};
    for (const auto& [old, with, words] : cases) {
        const auto file = folder.write("t.glb", glb(replaced(json, old, with), buffer));
        if (words == nullptr) {
            EXPECT_EQ(load_mesh(file).triangles.size(), 48u); // it has the plain data, too
            continue;
        }
        const std::string error = refused(file);
        EXPECT_NE(error.find(words), std::string::npos) << error;
    }
    const auto expect = [&](const std::string& text, const char* words) {
        const std::string error = refused(folder.write("t.gltf", text));
        EXPECT_NE(error.find(words), std::string::npos) << error;
    };
    std::string squeezed = replaced(json, R"("indices":1})",
                                    R"("indices":1,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0}}})");
    squeezed = replaced(squeezed, R"("bufferView":0,"componentType")", R"("componentType")");
    EXPECT_NE(refused(folder.write("t.glb", glb(squeezed, buffer))).find("compressed with Draco"), std::string::npos);
    expect(replaced(json, R"({"byteLength":864)",
                    R"({"extensions":{"EXT_meshopt_compression":{"fallback":true}},"byteLength":864)"),
           "compressed with meshopt");
    // As exporters wrote it: objects in place of lists, names for numbers.
    expect(R"({"asset":{"generator":"COLLADA2GLTF","version":"1.0"},"scene":"defaultScene","scenes":{},"meshes":{}})",
           "of glTF 1.0");
    expect(R"({"scene":"defaultScene","scenes":{"defaultScene":{"nodes":["n"]}},"nodes":{"n":{}},"meshes":{}})",
           "of glTF 1.0");
    const std::string binary("glTF\1\0\0\0\x20\0\0\0\x4\0\0\0\0\0\0\0{}  ", 24);
    EXPECT_NE(refused(folder.write("t.glb", binary)).find("of glTF 1.0"), std::string::npos);
}

TEST(HostileMesh, ManyPrimitivesInManyNodesAreNoLongWait) {
    const TempFolder folder;
    std::string nodes = R"({"mesh":0})", primitives = R"({"attributes":{}})";
    for (int i = 1; i < 45000; ++i) nodes += R"(,{"mesh":0})";
    for (int i = 1; i < 166000; ++i) primitives += R"(,{"attributes":{}})";
    const std::string error =
        refused(folder.write("many.gltf", R"({"asset":{"version":"2.0"},"nodes":[)" + nodes
                                              + R"(],"meshes":[{"primitives":[)" + primitives + "]}]}"));
    EXPECT_NE(error.find("places too many primitives"), std::string::npos) << error;
}

TEST(HostileMesh, GltfNestedDeepIsRefusedBeforeItIsParsed) {
    const TempFolder folder;
    const std::string json = gltf_json(sound(), R"([{"mesh":0}])", ""), buffer = gltf_buffer(sound());
    const auto with_extras = [&](const char* before, int depth) {
        const std::string extras = R"("extras":)" + std::string(static_cast<std::size_t>(depth), '[')
                                   + std::string(static_cast<std::size_t>(depth), ']') + ",";
        return folder.write("t.glb", glb(replaced(json, before, extras + before), buffer));
    };
    for (const char* place : {R"("asset")", R"("mesh":0)", R"("componentType")", R"("attributes")"}) {
        SCOPED_TRACE(place);
        EXPECT_NE(refused(with_extras(place, 15000)).find("nests its JSON more than 64 deep"), std::string::npos);
        EXPECT_EQ(load_mesh(with_extras(place, 40)).triangles.size(), sound().triangles.size());
    }
    // Brackets in a text nest nothing.
    const std::string text = R"("extras":"\"\\)" + std::string(200, '[') + R"(","asset")";
    EXPECT_EQ(load_mesh(folder.write("t.glb", glb(replaced(json, R"("asset")", text), buffer))).triangles.size(),
              sound().triangles.size());
}

TEST(HostileMesh, GltfThatPlacesMuchMoreThanItHoldsIsRefused) {
    const TempFolder folder;
    std::string nodes = R"({"mesh":0})", primitives = R"({"attributes":{"POSITION":0},"indices":1})", order = "0";
    for (int i = 1; i < 3000; ++i) nodes += R"(,{"mesh":0})", order.append(",").append(std::to_string(i));
    for (int i = 1; i < 600; ++i) primitives += R"(,{"attributes":{"POSITION":0},"indices":1})";
    const std::string json =
        replaced(gltf_json(sound(), "[" + nodes + "]", ""), R"("nodes":[0])", R"("nodes":[)" + order + "]");
    const std::string many = replaced(json, R"({"attributes":{"POSITION":0},"indices":1})", primitives);
    const std::string error = refused(folder.write("many.glb", glb(many, gltf_buffer(sound()))));
    EXPECT_NE(error.find("places the same meshes so often"), std::string::npos) << error;
}

TEST(HostileMesh, GltfReadsAFileOnceHoweverOftenItIsNamed) {
    const TempFolder folder;
    const std::string bytes = gltf_buffer(sound()), length = std::to_string(bytes.size());
    folder.write("b.bin", bytes + std::string(std::size_t{1} << 20, 'x')); // longer than its buffers, which is allowed
    const std::string json = gltf_json(sound(), R"([{"mesh":0}])", "b.bin");
    EXPECT_EQ(load_mesh(folder.write("t.gltf", json)).triangles.size(), sound().triangles.size());
    std::string more = R"("buffers":[)";
    for (int i = 0; i < 5000; ++i) more += R"({"byteLength":1000000,"uri":"./%62.bin"},)";
    const std::string named = replaced(replaced(json, R"("buffers":[)", more), R"({"buffer":0,"byteOffset":0)",
                                       R"({"buffer":5000,"byteOffset":0)");
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_AS, &before), 0);
    rlimit small = before;
    small.rlim_cur = rlim_t{2} << 30; // 5 GB where each buffer has its own copy
    if (!sanitized) {
        ASSERT_EQ(::setrlimit(RLIMIT_AS, &small), 0);
    }
    EXPECT_NO_THROW(load_mesh(folder.write("t.gltf", named)));
    EXPECT_EQ(::setrlimit(RLIMIT_AS, &before), 0);
}

TEST(HostileMesh, DeepChainOfNodesIsNoLongWait) {
    const TempFolder folder;
    std::string nodes = "[";
    for (int i = 1; i < 20000; ++i) nodes += R"({"mesh":1,"children":[)" + std::to_string(i) + "]},";
    const std::string json =
        replaced(gltf_json(sound(), nodes + R"({"mesh":0}])", ""), R"("accessors")", R"("unused":0,"accessors")");
    const std::string two =
        replaced(json, R"("meshes":[)", R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]},)");
    const std::string none = replaced(two, R"("POSITION":0},"indices":1}]},)", R"("COLOR_0":0}}]},)");
    const Mesh mesh = load_mesh(
        folder.write("chain.glb", glb(replaced(none, R"({"mesh":0}])", R"({"mesh":1}])"), gltf_buffer(sound()))));
    EXPECT_EQ(mesh.triangles.size(), 20000 * sound().triangles.size());
}

TEST(HostileMesh, PathsThatAreNoFiles) {
    const TempFolder folder;
    refused(folder.path() / "missing.obj");
    std::filesystem::create_directory(folder.path() / "folder.obj");
    EXPECT_NE(refused(folder.path() / "folder.obj").find("is a folder"), std::string::npos);
    std::filesystem::create_symlink("nowhere.obj", folder.path() / "dangling.obj");
    refused(folder.path() / "dangling.obj");
    std::filesystem::create_symlink("loop.obj", folder.path() / "loop.obj");
    refused(folder.path() / "loop.obj");
    ASSERT_EQ(::mkfifo((folder.path() / "pipe.obj").c_str(), 0600), 0);
    refused(folder.path() / "pipe.obj");
    refused(folder.write("file.obj", as_obj(sound())) / "below.obj");
    refused(folder.write("mesh.fbx", "x"));
    refused(folder.write("mesh", as_obj(sound())));
    try {
        load_mesh(folder.write("two\nlines.obj", "v 1 2 x"));
        ADD_FAILURE();
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
}

TEST(HostileMesh, NoPermission) {
    const TempFolder folder;
    const std::filesystem::path file = folder.write("secret.obj", as_obj(sound()));
    ASSERT_EQ(::chmod(file.c_str(), 0), 0);
    ASSERT_EQ(::chmod(folder.path().c_str(), 0755), 0);
    // Root may read everything, so a child gives up its rights first.
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        if (::getuid() == 0 && ::setuid(65534) != 0) ::_exit(3);
        int status = 1;
        try {
            load_mesh(file);
        } catch (const InputError& error) {
            status = std::string(error.what()).find("secret.obj: cannot be read") != std::string::npos ? 0 : 2;
        }
        ::_exit(status);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0);
}

} // namespace
