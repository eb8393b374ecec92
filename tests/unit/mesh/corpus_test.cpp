// SPDX-License-Identifier: Apache-2.0
// Small files as other programs write them, which fuzzers start from, too (tests/fuzz/corpus): the parts that each has,
// their triangles, and what is said to be left out; or why it is refused.
#include "tests/unit/mesh/formats.h"
#include "tests/unit/mesh/solids.h"

#ifdef RAYCONTACT_3MF
#include "tests/unit/mesh/packages.h"
#endif

#include <raycontact/assembly.h>
#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

using namespace raycontact;
using namespace raycontact::test;

namespace {

using Table = std::vector<std::pair<std::string, std::string>>;

std::string content_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    EXPECT_TRUE(file) << path;
    return {std::istreambuf_iterator<char>(file), {}};
}

std::string words_of(const std::filesystem::path& file) {
    try {
        std::vector<std::string> left_out;
        std::string words;
        std::size_t triangles = 0;
        for (const AssemblyPart& part : load_assembly(file, &left_out)) {
            words += (words.empty() ? "" : ", ") + part.name + ": " + std::to_string(part.mesh->triangles.size());
            triangles += part.mesh->triangles.size();
        }
        for (const std::string& line : left_out) words += "; " + line;
        EXPECT_EQ(load_mesh(file).triangles.size(), triangles);
        return words;
    } catch (const InputError& error) {
        EXPECT_THROW(load_mesh(file), InputError);
        const std::string line = error.what();
        const std::string name = file.filename().string() + ": ";
        EXPECT_NE(line.find(name), std::string::npos) << line;
        return "refused: " + line.substr(line.find(name) + name.size());
    }
}

/// Files of the folder of a format.
void expect(const std::string& format, const Table& table) {
    const TempFolder folder;
    folder.write("m.bin", gltf_buffer(torus(6, 4, 1, 0.3))); // as the fuzzer has it
    for (const auto& [name, words] : table) {
        SCOPED_TRACE(format + "/" + name);
        std::string bytes = content_of(std::filesystem::path(RAYCONTACT_CORPUS) / format / name);
#ifdef RAYCONTACT_3MF
        if (format == "3mf" && !bytes.starts_with("PK")) bytes = zip_of(parts_3mf(bytes));
#endif
        EXPECT_EQ(words_of(folder.write("m." + format, bytes)), words);
    }
}

TEST(Corpus, Obj) {
    expect(
        "obj",
        {
            {"as_written", "m.obj: 4; left out 1 vertex that is not finite and that no triangle uses; "
                           "left out 1 face of two corners; left out 2 points (p); left out 1 line (l); left out 2 "
                           "free-form elements (curv, surf); left out 1 call of other files or commands; left out 3 "
                           "padding bytes at the end; left out what has no triangles: 'empty'"},
            {"ctrl_z", "m.obj: 4; left out 1 padding byte at the end"},
            {"groups", "red side and 1 more: 4, other: 4; joined patches of one surface to a part: 'red side', 'blue'"},
            {"left_out", "m.obj: 4; left out 2 faces of two corners; left out 3 points (p); left out 1 line (l); left "
                         "out 2 free-form elements (curv, surf); left out 2 calls of other files or commands"},
            {"negative", "m.obj: 4"},
            {"not_finite", "m.obj: 4; left out 2 vertices that are not finite and that no triangle uses"},
            {"objects", "one: 4, two: 4"},
            {"polygons", "m.obj: 16"},
            {"sound", "m.obj: 12"},
            {"utf16", "m.obj: 5"},
        });
}

TEST(Corpus, Stl) {
    expect("stl",
           {
               {"ascii", "m.stl: 12"},
               {"binary", "m.stl: 12"},
               {"capitals", "m.stl: 4"},
               {"colour", "m.stl: 4"},
               {"comment_first", "m.stl: 4"},
               {"count_unknown", "m.stl: 4; counted 4 facets from the file's size, as its header says 4294967295"},
               {"count_zero", "m.stl: 4; counted 4 facets from the file's size, as its header says 0; left out 4 bytes "
                              "behind the last facet"},
               {"footer", "m.stl: 4; left out 19 bytes behind the last facet"},
               {"joined", "solids[0]: 4, solids[1]: 4"},
               {"payload", "m.stl: 4; skipped the attributes behind the facets, 6 bytes"},
               {"solids", "one: 4, solids[1] and 1 more: 4; left out what has no triangles: 'none'; joined patches of "
                          "one surface to a part: 'solids[1]', 'patch'"},
           });
}

TEST(Corpus, Ply) {
    expect("ply", {
                      {"ascii", "m.ply: 12"},
                      {"big", "m.ply: 12"},
                      {"left_out", "m.ply: 4; left out 1 record of element 'edge'; left out 1 record of element "
                                   "'trifans'; left out 1 face of two corners"},
                      {"little", "m.ply: 12"},
                      {"not_finite", "m.ply: 4; left out 1 vertex that is not finite and that no triangle uses"},
                      {"polygons", "m.ply: 6"},
                      {"strips_alone", "m.ply: 3"},
                      {"texture", "m.ply: 4"},
                      {"tristrips", "m.ply: 4; left out 1 record of element 'edge'; left out 1 vertex that is not "
                                    "finite and that no triangle uses; left out 1 face of two corners"},
                      {"tristrips_binary", "m.ply: 3; left out 1 vertex that is not finite and that no triangle uses"},
                  });
}

TEST(Corpus, Off) {
    expect("off", {
                      {"no_edges", "m.off: 4"},
                      {"normals", "m.off: 4"},
                      {"not_finite", "m.off: 4; left out 1 vertex that is not finite and that no triangle uses; left "
                                     "out 1 face of two corners"},
                      {"one_word", "m.off: 4"},
                      {"polygons", "m.off: 7"},
                      {"small_letters", "m.off: 4; left out 1 vertex that is not finite and that no triangle uses; "
                                        "left out 1 face of two corners"},
                      {"sound", "m.off: 12"},
                  });
}

TEST(Corpus, Gltf) {
    expect(
        "gltf",
        {
            {"binary", "nodes[0]: 12"},
            {"centre", "nodes[1]: 48"},
            {"draco", "refused: its meshes are compressed with Draco, which is not read; decompress it "
                      "(`gltf-transform copy IN.glb OUT.glb` does), or export it without compression"},
            {"hidden", "nodes[2]: 48; left out 'nodes[0]', 'nodes[1]': hidden (KHR_node_visibility)"},
            {"instances", "n[0]: 48, n[1]: 48, n[2]: 48, n[3]: 48, n[4]: 48, n[5]: 48, n[6]: 48, n[7]: 48, n[8]: 48, "
                          "n[9]: 48, n[10]: 48, n[11]: 48, n[12]: 48, n[13]: 48, n[14]: 48, n[15]: 48, n[16]: 48, "
                          "n[17]: 48, n[18]: 48, n[19]: 48, n[20]: 48, n[21]: 48, n[22]: 48, n[23]: 48"},
            {"instances_turned", "nodes[0][0]: 48, nodes[0][1]: 48"},
            {"left_out", "nodes[0]: 48; left out 'nodes[1]': hidden (KHR_node_visibility); left out 'nodes[2]': lower "
                         "levels of detail (MSFT_lod); left out 'nodes[3]': not in the scene; left out what the "
                         "extension 'AGI_articulations' moves or adds; it is not read"},
            {"levels", "fine: 48; left out 'coarse', 'box': lower levels of detail (MSFT_lod)"},
            {"morph", "nodes[0]: 4, nodes[1]: 4"},
            {"skin", "nodes[1]: 4"},
            {"unknown_extension",
             "nodes[0]: 48; left out what the extension 'ACME_bend' moves or adds; it is not read"},
            {"version_1",
             "refused: is of glTF 1.0, which is not read; convert it to glTF 2.0 (`gltf-pipeline -i IN -o OUT` does)"},
            {"with_buffer", "nodes[0]: 48"},
        });
}

#ifdef RAYCONTACT_3MF
TEST(Corpus, ThreeMf) {
    expect(
        "3mf",
        {
            {"components", "a: 4, a: 4, a: 4, a: 4, a: 4"},
            {"empty_mesh", "object 2: 4; left out 'spare': not in the build; left out what has no triangles: 'void'"},
            {"lattice",
             "object 1: 4; left out 1 x beamlattice of "
             "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02 of object 1, which is not read"},
            {"mirrored", "object 1: 4, object 1: 4"},
            {"missing_model", "refused: has no part 3d/none.model; it is no whole 3MF file, export it again"},
            {"model", "a: 4, a: 4, a: 4, a: 4"},
            {"other_model", "object 1: 4"},
            {"package", "a: 4, a: 4, a: 4, a: 4"},
            {"production", "far: 4, far: 4"},
        });
}
#else
TEST(Corpus, ABuildWithout3mfSaysSo) {
    expect("3mf", {{"model", "refused: 3MF is not read by this build of the library (RAYCONTACT_3MF is off); convert "
                             "it to GLB or STL"}});
    const TempFolder folder;
    EXPECT_EQ(words_of(folder.write("m.stp", "x")),
              "refused: unknown ending '.stp'; known are .obj .stl .ply .off .gltf .glb");
}
#endif

} // namespace
