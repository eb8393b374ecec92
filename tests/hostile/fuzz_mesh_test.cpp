// SPDX-License-Identifier: Apache-2.0
// Sound files with some bytes changed, cut or doubled at random: each loads or is refused, and nothing else happens.
// Worth most under AddressSanitizer and UndefinedBehaviorSanitizer.
#include "tests/unit/mesh/formats.h"
#ifdef RAYCONTACT_3MF
#include "tests/unit/mesh/packages.h"
#endif
#include "tests/unit/mesh/solids.h"

#include "mesh/input_file.h"

#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <random>
#include <string>

using namespace raycontact;
using namespace raycontact::test;

namespace {

std::string damaged(std::string bytes, std::mt19937& random) {
    const auto at = [&] { return random() % bytes.size(); };
    const auto changes = 1 + random() % 4;
    for (unsigned i = 0; i < changes && bytes.size() > 8; ++i) {
        switch (random() % 6) {
        case 0:
            bytes[at()] = static_cast<char>(random());
            break;
        case 1:
            bytes[at()] ^= static_cast<char>(1u << random() % 8);
            break;
        case 2:
            bytes.erase(at(), 1 + random() % 8);
            break;
        case 3:
            bytes.insert(at(), bytes.substr(at(), 1 + random() % 16));
            break;
        case 4:
            bytes.resize(1 + at());
            break;
        default: { // another digit, where there is one: damage that parses
            const std::size_t start = at();
            for (std::size_t k = start; k < bytes.size(); ++k) {
                if (std::isdigit(static_cast<unsigned char>(bytes[k]))) {
                    bytes[k] = static_cast<char>('0' + random() % 10);
                    break;
                }
            }
        }
        }
    }
    return bytes;
}

using Reader = Mesh (*)(const InputFile&);

/// In memory: thousands of small files would only measure the disk.
void fuzz(Reader read, const std::string& sound, int rounds, const std::filesystem::path& path = "m") {
    std::mt19937 random(20131117);
    int loaded = 0, refused = 0;
    for (int i = 0; i < rounds; ++i) {
        const InputFile file{path, "m", damaged(sound, random)};
        try {
            const PreparedMesh mesh = prepare_mesh(read(file));
            to_json(mesh.report);
            for (const auto& t : mesh.triangles) {
                for (const std::uint32_t v : t) ASSERT_LT(v, mesh.vertices.size());
            }
            ++loaded;
        } catch (const InputError& error) {
            ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
            ++refused;
        } catch (const std::exception& other) {
            FAIL() << "round " << i << ": not an InputError: " << other.what();
        }
    }
    // Both must happen, or the damage is not of the kind that is meant.
    EXPECT_GT(loaded, rounds / 100);
    EXPECT_GT(refused, rounds / 10);
}

constexpr int rounds = 3000;
Mesh sound() {
    return torus(6, 4, 1, 0.3);
}

TEST(FuzzMesh, Obj) {
    fuzz(&read_obj, as_obj(sound()), rounds);
}
/// A prism over a concave polygon, with a corner on a side, and its faces before the last vertices.
std::string polygons() {
    return "v 0 0 0\nv 9 0 0\nv 9 9 0\nv 6 9 0\nv 6 3 0\nv 3 3 0\nv 3 9 0\nv 0 9 0\nv 0 4 0\nv 0 0 2\nv 9 0 2\n"
           "v 9 9 2\nv 6 9 2\nv 6 3 2\nv 3 3 2\nf 9 8 7 6 5 4 3 2 1\nf 10 11 12 13 14 15 16 17 18\nf 1 2 11 10\n"
           "f 2 3 12 11\nf 3 4 13 12\nf 4 5 14 13\nf 5 6 15 14\nf 6 7 16 15\nf 7 8 17 16\nf 8 9 18 17\nf 9 1 10 18\n"
           "v 3 9 2\nv 0 9 2\nv 0 4 2\n";
}
TEST(FuzzMesh, ObjOfPolygons) {
    fuzz(&read_obj, polygons(), rounds);
}
TEST(FuzzMesh, ObjInUtf16) {
    std::string wide = "\xff\xfe";
    for (const char c : as_obj(sound())) {
        wide += c;
        wide += '\0';
    }
    fuzz(&read_obj, wide, rounds);
}
TEST(FuzzMesh, Off) {
    fuzz(&read_off, as_off(sound()), rounds);
}
TEST(FuzzMesh, AsciiStl) {
    fuzz(&read_stl, as_ascii_stl(sound()), rounds);
}
TEST(FuzzMesh, BinaryStl) {
    fuzz(&read_stl, as_binary_stl(sound()), rounds);
}
TEST(FuzzMesh, AsciiPly) {
    fuzz(&read_ply, as_ascii_ply(sound()), rounds);
}
TEST(FuzzMesh, PlyStrips) {
    std::string text = as_ascii_ply(sound());
    text.replace(text.find("element face"), 12, "element tristrips");
    fuzz(&read_ply, text, rounds);
}
TEST(FuzzMesh, BinaryPly) {
    fuzz(&read_ply, as_binary_ply(sound()), rounds);
}
TEST(FuzzMesh, Glb) {
    fuzz(&read_gltf, as_glb(sound()), rounds);
}
TEST(FuzzMesh, GlbJsonAlone) {
    // The description counts for more than the data, so most damage goes there.
    const std::string nodes =
        R"([{"mesh":0,"children":[1]},{"scale":[1,2,1],"children":[2]},{"mesh":0,"translation":[4,0,0]}])";
    const TempFolder folder;
    folder.write("m.bin", gltf_buffer(sound()));
    fuzz(&read_gltf, gltf_json(sound(), nodes, "m.bin"), rounds, folder.path() / "m.gltf");
}
#ifdef RAYCONTACT_3MF
TEST(FuzzMesh, Packages) {
    fuzz(&read_3mf, as_3mf(sound()), rounds);
}
TEST(FuzzMesh, ModelsInPackages) {
    const std::string pair =
        R"(<component objectid="1" transform="1 0 0 0 1 0 0 0 1 4 0 0"/><component objectid="1"/>)";
    fuzz(
        [](const InputFile& model) {
            return read_3mf({model.path, model.shown, zip_of(parts_3mf(model.bytes), false)});
        },
        model_3mf(object_3mf(sound(), R"(id="1")") + R"(<object id="2"><components>)" + pair + "</components></object>",
                  R"(<item objectid="2"/>)"),
        rounds);
}
#endif

} // namespace
