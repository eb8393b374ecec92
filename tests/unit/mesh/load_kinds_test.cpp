// SPDX-License-Identifier: Apache-2.0
// Files as other programs write them: what is read of them, and that what is not read is counted or named.
#include "tests/unit/mesh/formats.h"
#include "tests/unit/mesh/load_error.h"
#include "tests/unit/mesh/solids.h"

#include <raycontact/assembly.h>
#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include <gtest/gtest.h>

using namespace raycontact;
using namespace raycontact::test;

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;
using Texts = std::vector<std::string>;

const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

void expect_error(const std::filesystem::path& file, const std::string& words) {
    EXPECT_NE(error_of(file).find(words), std::string::npos) << error_of(file) << "\nlacks: " << words;
}

std::string replaced(std::string text, const std::string& old, const std::string& with) {
    const std::size_t at = text.find(old);
    EXPECT_NE(at, std::string::npos) << old;
    return text.replace(at, old.size(), with);
}

std::string with_count(std::uint32_t count) {
    std::string bytes;
    put(bytes, count);
    return as_binary_stl(box()).replace(80, 4, bytes);
}

TEST(LoadKinds, StlCountsItsFacetsFromTheSizeWhereTheHeaderDoesNot) {
    const TempFolder folder;
    const Mesh whole = load_mesh(folder.write("m.stl", as_binary_stl(box())));
    EXPECT_EQ(whole.repairs, Texts());
    for (const std::uint32_t count : {0u, 0xffffffffu, 7u}) {
        const Mesh mesh = load_mesh(folder.write("m.stl", with_count(count)));
        EXPECT_EQ(mesh.vertices, whole.vertices);
        EXPECT_EQ(mesh.repairs,
                  Texts{"counted 12 facets from the file's size, as its header says " + std::to_string(count)});
        EXPECT_EQ(prepare_mesh(mesh).report.repairs, mesh.repairs);
    }
    const Mesh longer = load_mesh(folder.write("m.stl", as_binary_stl(box()) + "footer"));
    EXPECT_EQ(longer.vertices, whole.vertices);
    EXPECT_EQ(longer.repairs, Texts{"left out 6 bytes behind the last facet"});
    EXPECT_EQ(load_mesh(folder.write("m.stl", with_count(0) + "x")).repairs.size(), 2u);
    expect_error(folder.write("m.stl", with_count(13)), "a binary STL file of 13 facets has 734 bytes, this one 684");
}

TEST(LoadKinds, StlAttributesWithAPayloadAreSkipped) {
    const TempFolder folder;
    const std::string plain = as_binary_stl(box());
    std::string bytes = plain.substr(0, 84);
    for (std::uint16_t i = 0; i < 12; ++i) {
        bytes += plain.substr(84 + 50 * std::size_t{i}, 48);
        put(bytes, i);
        bytes += std::string(i, 'p');
    }
    const Mesh mesh = load_mesh(folder.write("m.stl", bytes));
    EXPECT_EQ(mesh.vertices, load_mesh(folder.write("p.stl", plain)).vertices);
    EXPECT_EQ(mesh.repairs, Texts{"skipped the attributes behind the facets, 66 bytes"});
}

TEST(LoadKinds, StlIsBinaryByItsBytesAndNotByTheWordSolid) {
    const TempFolder folder;
    const std::string binary = as_binary_stl(box()); // its header begins with `solid`
    expect_error(folder.write("m.stl", binary.substr(0, 600)), "a binary STL file of 12 facets has 684 bytes");
    expect_error(folder.write("m.stl", binary.substr(0, 50)), "has 50 bytes, fewer than an STL file with a facet");
    const Mesh made = load_mesh(folder.write("m.stl", as_ascii_stl(box())));
    for (const char* before : {"\n \r\n\n", "# made by hand\n\n", "; exported\n// twice\n", "\xef\xbb\xbf\n"}) {
        SCOPED_TRACE(before);
        EXPECT_EQ(load_mesh(folder.write("m.stl", before + as_ascii_stl(box()))).vertices, made.vertices);
    }
    expect_error(folder.write("m.stl", "# x\n" + as_ascii_stl(box()).substr(28)), "line 2: 'facet' where solid");
    expect_error(folder.write("m.stl", std::string(200, '#')), "is neither a text STL file");
}

TEST(LoadKinds, StlSolidsArePartsByTheirNames) {
    const TempFolder folder;
    const auto solid = [](const Mesh& mesh, const std::string& name) {
        return replaced(as_ascii_stl(mesh), "solid a name of three words", "solid " + name);
    };
    Mesh far = box();
    for (Vec3& v : far.vertices) v.x += 1; // shares a face, and no edge is open
    const auto file =
        folder.write("m.stl", solid(box(), "  left one ") + solid(far, "") + "solid none\nendsolid none\n");
    EXPECT_EQ(load_mesh(file).triangles.size(), 24u);
    Texts left_out;
    const std::vector<AssemblyPart> parts = load_assembly(file, &left_out);
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_EQ(parts[0].name, "left one");
    EXPECT_EQ(parts[1].name, "solids[1]");
    EXPECT_EQ(parts[1].mesh->name, "solids[1]");
    EXPECT_EQ(left_out, Texts{"left out what has no triangles: 'none'"});
    EXPECT_EQ(parts[1].mesh->triangles[11], (std::array<std::uint32_t, 3>{33, 34, 35}));
    const MeshReport report = prepare_mesh(*parts[1].mesh).report;
    EXPECT_EQ(report.volume, 1);
    EXPECT_EQ(report.box_min, (Vec3{1, 0, 0}));
    // One solid is the file.
    EXPECT_EQ(load_assembly(folder.write("one.stl", solid(box(), "x")))[0].name, "one.stl");
}

TEST(LoadKinds, BinaryStlFilesJoinedEndToEndAreSolids) {
    const TempFolder folder;
    Mesh far = box();
    for (Vec3& v : far.vertices) v.x += 1; // shares a face, and no edge is open
    far.triangles.pop_back();
    far.triangles.pop_back();
    const std::string near = as_binary_stl(box()), two = near + as_binary_stl(far);
    const auto file = folder.write("m.stl", two);
    const Mesh whole = load_mesh(file);
    EXPECT_EQ(whole.triangles.size(), 22u);
    EXPECT_EQ(whole.repairs, Texts());
    EXPECT_EQ(whole.triangles[12], (std::array<std::uint32_t, 3>{36, 37, 38}));
    const std::vector<AssemblyPart> parts = load_assembly(file);
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_EQ(parts[0].name, "solids[0]");
    EXPECT_EQ(prepare_mesh(*parts[0].mesh).report.volume, 1);
    EXPECT_EQ(parts[1].name, "solids[1]");
    EXPECT_EQ(prepare_mesh(*parts[1].mesh).report.box_min, (Vec3{1, 0, 0}));
    // So many that the headers are as long as some facets.
    std::string many;
    for (int i = 0; i < 26; ++i) many += near;
    EXPECT_EQ(load_mesh(folder.write("many.stl", many)).triangles.size(), 26 * 12u);
    EXPECT_EQ(load_assembly(folder.write("one.stl", near))[0].name, "one.stl");
    // What does not fill the file exactly is counted as bytes, not guessed at.
    for (const std::string& bytes : {two.substr(0, two.size() - 1), two + "x", near + std::string(84, '\0')}) {
        const Mesh mesh = load_mesh(folder.write("m.stl", bytes));
        EXPECT_EQ(mesh.triangles.size(), 12u);
        EXPECT_EQ(mesh.repairs,
                  Texts{"left out " + std::to_string(bytes.size() - near.size()) + " bytes behind the last facet"});
    }
    std::string damaged = two;
    damaged.replace(near.size() + 84 + 12, 4, "\0\0\xc0\x7f", 4);
    expect_error(folder.write("m.stl", damaged), "facet 12: a coordinate is not finite");
}

/// As OBJ, with statements before its faces.
std::string grouped(const Mesh& mesh, std::size_t first,
                    const std::vector<std::pair<std::size_t, std::string>>& lines) {
    std::string text, faces;
    for (const Vec3& v : mesh.vertices) text += "v " + test::text(v) + "\n";
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (const auto& [at, line] : lines)
            if (at == t) faces += line + "\n";
        faces += "f";
        for (const std::uint32_t v : mesh.triangles[t]) faces.append(" ").append(std::to_string(first + v));
        faces += "\n";
    }
    return text + faces;
}

TEST(LoadKinds, ObjObjectsElseGroupsAreParts) {
    const TempFolder folder;
    const auto parts_of = [&](const std::string& text, Texts* left_out = nullptr) {
        return load_assembly(folder.write("m.obj", text), left_out);
    };
    for (const std::string kind : {"o", "g"}) {
        Texts left_out;
        const auto parts = parts_of(grouped(box(), 1, {{0, kind + " the first"}}) + kind + "\n" + kind + " empty\n"
                                        + grouped(box(2), 9, {{0, kind + " b"}, {5, kind + " c"}, {7, kind + " b"}}),
                                    &left_out);
        // c is a hole in b: open in both.
        ASSERT_EQ(parts.size(), 2u);
        EXPECT_EQ(parts[0].name, "the first");
        EXPECT_EQ(prepare_mesh(*parts[0].mesh).report.volume, 1);
        EXPECT_EQ(parts[1].name, "b and 1 more");
        EXPECT_EQ(parts[1].mesh->triangles.size(), 12u);
        EXPECT_EQ(prepare_mesh(*parts[1].mesh).report.volume, 8);
        EXPECT_EQ(left_out, (Texts{"left out what has no triangles: 'empty'",
                                   "joined patches of one surface to a part: 'b', 'c'"}));
    }
    // Faces before any name, and groups in one object.
    const auto two = parts_of("o all\n" + grouped(box(), 1, {}) + grouped(box(2), 9, {{0, "g second"}}));
    ASSERT_EQ(two.size(), 2u);
    EXPECT_EQ(two[0].name, "default");
    EXPECT_EQ(two[1].name, "second");
    // Materials cut one surface.
    const auto one = parts_of(grouped(box(), 1, {{0, "g red"}, {6, "g blue"}}));
    ASSERT_EQ(one.size(), 1u);
    EXPECT_EQ(one[0].name, "m.obj");
}

TEST(LoadKinds, ObjectsAreOnePartWhereTheyShareABorder) {
    const TempFolder folder;
    using Names = std::vector<std::string>;
    const auto names_of = [&](const std::string& text) {
        Names names;
        for (const AssemblyPart& part : load_assembly(folder.write("m.obj", text))) names.push_back(part.name);
        return names;
    };
    // Each face is an object with vertices of its own, as some programs write a CAD body.
    const auto face = [](const Mesh& mesh, std::size_t k) {
        Mesh own;
        for (std::size_t t = 2 * k; t < 2 * k + 2; ++t) {
            const auto [a, b, c] = mesh.triangles[t];
            append(own, {"", {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]}, {{0, 1, 2}}});
        }
        return own;
    };
    const auto by_faces = [&](const Mesh& mesh, std::size_t first) {
        std::string text;
        for (std::size_t k = 0; k < 6; ++k)
            text += grouped(face(mesh, k), first + 6 * k, {{0, "o face " + std::to_string(k)}});
        return text;
    };
    EXPECT_EQ(names_of(by_faces(box(), 1)), Names{"m.obj"});
    Mesh apart = box(), beside = box();
    for (Vec3& v : apart.vertices) v.x += 3;
    for (Vec3& v : beside.vertices) v.x += 1;
    EXPECT_EQ(names_of(by_faces(box(), 1) + grouped(apart, 37, {{0, "o other"}})),
              (Names{"face 0 and 5 more", "other"}));
    // Closed objects have no border: they stay parts where they share a face, or an edge with an open one.
    const std::string two = grouped(box(), 1, {{0, "o left"}}) + grouped(beside, 9, {{0, "o right"}});
    EXPECT_EQ(names_of(two), (Names{"left", "right"}));
    EXPECT_EQ(names_of(two + grouped(face(apart, 0), 17, {{0, "o sheet"}})), (Names{"left", "right", "sheet"}));
    EXPECT_EQ(names_of(two + grouped(face(beside, 3), 17, {{0, "o sheet"}})), (Names{"left", "right", "sheet"}));
    // A sheet that was cut into objects is one; sheets that share a vertex at most are several.
    const auto sheet = [&](double x, double y, std::size_t first, const std::string& name) {
        const Mesh quad{"", {{x, y, 0}, {x + 1, y, 0}, {x + 1, y + 1, 0}, {x, y + 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
        return grouped(quad, first, {{0, "o " + name}});
    };
    EXPECT_EQ(names_of(sheet(0, 0, 1, "a") + sheet(1, 0, 5, "b") + sheet(2, 0, 9, "c")), Names{"m.obj"});
    EXPECT_EQ(names_of(sheet(0, 0, 1, "a") + sheet(1, 1, 5, "b") + sheet(5, 0, 9, "c")), (Names{"a", "b", "c"}));
}

TEST(LoadKinds, ObjAsModellersWriteIt) {
    const TempFolder folder;
    const auto load = [&](const std::string& tail) { return load_mesh(folder.write("m.obj", three + tail)); };
    for (const std::string tail : {"f 1// 2// 3//\n", "f 1/ 2/ 3/\n", "f 1 2 \\ \t\n 3\n", "f 1 2 3\n\x1a"}) {
        SCOPED_TRACE(tail);
        EXPECT_EQ(load(tail).triangles, (Triangles{{0, 1, 2}}));
    }
    const std::string pad("\0\x1a\0", 3);
    for (const auto& file :
         {folder.write("a.ply", as_ascii_ply(box()) + pad), folder.write("b.ply", as_binary_ply(box()) + pad),
          folder.write("m.off", as_off(box()) + pad), folder.write("m.stl", as_ascii_stl(box()) + pad)})
        EXPECT_EQ(load_mesh(file).triangles.size(), 12u) << file;
    const Mesh padded = load(std::string("f 1 2 3\n\0\0\x1a\0", 12));
    EXPECT_EQ(padded.triangles, (Triangles{{0, 1, 2}}));
    EXPECT_EQ(padded.repairs, Texts{"left out 4 padding bytes at the end"});
    expect_error(folder.write("m.obj", three + std::string("f 1 2 3\n\0v 1 2 3\n", 17)), "is no OBJ statement");
}

TEST(LoadKinds, ObjCountsWhatIsNoTriangle) {
    const TempFolder folder;
    const std::string others = "p 1 2 3\np -1\nl 1 2 \\\n3\nl 1 2\ncall x.obj 1\ncsh ls\ncstype bezier\ndeg 3\n"
                               "curv 0 1 1 2 3\nsurf 0 1 0 1 1 2 3\nend\nf 1 2\nf 1/1 2/2\n";
    const std::string counts =
        "left out 2 faces of two corners, left out 4 points (p), left out 2 lines (l), "
        "left out 2 free-form elements (curv, surf), left out 2 calls of other files or commands";
    const Mesh mesh = load_mesh(folder.write("m.obj", three + others + "f 1 2 3\n"));
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}}));
    std::string told;
    for (const std::string& repair : mesh.repairs) told += (told.empty() ? "" : ", ") + repair;
    EXPECT_EQ(told, counts);
    expect_error(folder.write("m.obj", three + others), "m.obj: has no triangles (" + counts + ")");
}

TEST(LoadKinds, VerticesThatAreNotFiniteCountOnlyWhereATriangleUsesThem) {
    const TempFolder folder;
    const std::vector<std::pair<std::string, std::string>> words{{"-1.#IND", "is not a number (NaN)"},
                                                                 {"1.#QNAN0", "is not a number (NaN)"},
                                                                 {"nan", "is not a number (NaN)"},
                                                                 {"-nan(ind)", "is not a number (NaN)"},
                                                                 {"1.#INF00", "is not finite"},
                                                                 {"-inf", "is not finite"},
                                                                 {"1e999", "is not finite"}};
    for (const auto& [word, what] : words) {
        SCOPED_TRACE(word);
        const std::string bad = "0 " + word + " 0\n", points = bad + "5 5 5\n6 5 5\n5 6 5\n" + bad;
        const std::string obj = "v " + bad + "v 5 5 5\nv 6 5 5\nv 5 6 5\nv " + bad;
        const std::string ply = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
                                "property float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n";
        const std::string quoted = "'" + word + "' ";
        for (const auto& file :
             {folder.write("m.obj", obj + "f 2 3 4\n"), folder.write("m.ply", ply + points + "3 1 2 3\n"),
              folder.write("m.off", "OFF 5 1 0\n" + points + "3 1 2 3\n")}) {
            const Mesh mesh = load_mesh(file);
            EXPECT_EQ(mesh.triangles, (Triangles{{1, 2, 3}}));
            EXPECT_EQ(mesh.vertices[0], (Vec3{5, 5, 5}));
            EXPECT_EQ(mesh.vertices[4], (Vec3{5, 5, 5}));
            EXPECT_EQ(mesh.repairs, Texts{"left out 2 vertices that are not finite and that no triangle uses"});
        }
        expect_error(folder.write("m.obj", obj + "f 2 3 5\n"), "line 5: coordinate " + quoted + what);
        expect_error(folder.write("m.ply", ply + points + "3 1 2 4\n"), "line 14: coordinate " + quoted + what);
        expect_error(folder.write("m.off", "OFF 5 1 0\n" + points + "3 1 2 4\n"),
                     "line 6: coordinate " + quoted + what);
        expect_error(folder.write("m.stl", replaced(as_ascii_stl(box()), "vertex 0", "vertex " + word)),
                     "coordinate " + quoted + what);
    }
    Mesh made = box();
    made.vertices.push_back({0, 0, std::numeric_limits<double>::quiet_NaN()});
    for (const auto& file : {folder.write("m.ply", as_binary_ply(made)), folder.write("m.glb", as_glb(made))}) {
        const Mesh mesh = load_mesh(file);
        EXPECT_EQ(mesh.vertices[8], mesh.vertices[0]);
        EXPECT_EQ(mesh.repairs, Texts{"left out 1 vertex that is not finite and that no triangle uses"});
    }
    // A colour is not used.
    EXPECT_EQ(load_mesh(folder.write("m.obj", three + "v 0 0 1 nan 1.#IND 0\nf 1 2 4\n")).repairs, Texts());
    // What is a comment stays one.
    EXPECT_EQ(load_mesh(folder.write("m.obj", "v 0. 0 1.#IN\nv 1 0 2.#5\nv 0 1 0\nf 1 2 3#4\n")).vertices[1].z, 2);
}

std::string ply_with(const std::string& faces, const std::string& data) {
    return "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n" + faces
           + "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 1 0\n" + data;
}

TEST(LoadKinds, PlyStripsAloneAndBesideFaces) {
    const TempFolder folder;
    const std::string strips = "element tristrips 2\nproperty list int int vertex_indices\n";
    const std::string data = "9 0 1 2 3 -1 1 4 3 -1\n3 2 1 3\n";
    const Triangles expected{{0, 1, 2}, {2, 1, 3}, {1, 4, 3}, {2, 1, 3}};
    EXPECT_EQ(load_mesh(folder.write("m.ply", ply_with(strips, data))).triangles, expected);
    Triangles both{{0, 1, 4}};
    both.insert(both.end(), expected.begin(), expected.end());
    EXPECT_EQ(
        load_mesh(folder.write("m.ply", ply_with("element face 1\nproperty list uchar int vertex_indices\n" + strips,
                                                 "3 0 1 4\n" + data)))
            .triangles,
        both);
    expect_error(folder.write("m.ply", ply_with(strips, "3 0 1 5\n3 0 1 2\n")), "vertex index 5 is not in 0 to 5 - 1");
    expect_error(folder.write("m.ply", ply_with(strips, "3 0 1 -2\n3 0 1 2\n")), "vertex index -2 is out of range");
    expect_error(folder.write("m.ply", ply_with("element tristrips 1\nproperty int n\n", "1\n")), "lacks a list");
    // Binary and unsigned: -1 is 2^32 - 1.
    std::string binary = "ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
                         "property float z\nelement tristrips 1\nproperty list uint uint vertex_indices\nend_header\n";
    for (const Vec3& v : box().vertices)
        for (const double c : {v.x, v.y, v.z}) put(binary, static_cast<float>(c));
    put(binary, static_cast<std::uint32_t>(4 * box().triangles.size()));
    for (const auto& triangle : box().triangles) {
        for (const std::uint32_t v : triangle) put(binary, v);
        put(binary, 0xffffffffu);
    }
    EXPECT_EQ(load_mesh(folder.write("m.ply", binary)).triangles, box().triangles);
}

TEST(LoadKinds, PlyAndOffCountWhatIsNoTriangle) {
    const TempFolder folder;
    const std::string faces = "element face 2\nproperty list uchar int vertex_indices\n";
    const Mesh ply =
        load_mesh(folder.write("m.ply", ply_with(faces
                                                     + "element edge 2\nproperty int vertex1\nproperty int vertex2\n"
                                                       "element trifans 1\nproperty list uchar int vertex_indices\n",
                                                 "2 0 1\n3 0 1 2\n0 1\n1 2\n3 0 1 4\n")));
    EXPECT_EQ(ply.triangles, (Triangles{{0, 1, 2}}));
    EXPECT_EQ(ply.repairs, (Texts{"left out 2 records of element 'edge'", "left out 1 record of element 'trifans'",
                                  "left out 1 face of two corners"}));
    const Mesh off = load_mesh(folder.write("m.off", "OFF 3 2 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1 255 0 0\n3 0 1 2\n"));
    EXPECT_EQ(off.triangles, (Triangles{{0, 1, 2}}));
    EXPECT_EQ(off.repairs, Texts{"left out 1 face of two corners"});
}

TEST(LoadKinds, OffHeadersInOneWordAndInSmallLetters) {
    const TempFolder folder;
    const std::string plain = as_off(box());
    for (const char* header : {"OFF8 12 0\n", "off\n8 12 0\n", "off8 12 0\n", "Off 8 12 0\n", "OFF 8 12\n"}) {
        SCOPED_TRACE(header);
        const Mesh mesh = load_mesh(folder.write("m.off", replaced(plain, "OFF\n8 12 0\n", header)));
        EXPECT_EQ(mesh.vertices, box().vertices);
        EXPECT_EQ(mesh.triangles, box().triangles);
    }
    const std::string coloured = "3 1\n0 0 0 9 9 9\n1 0 0 9 9 9\n0 1 0 9 9 9\n3 0 1 2\n";
    for (const char* header : {"COFF", "NOFF", "coff", "STCNOFF"})
        EXPECT_EQ(load_mesh(folder.write("m.off", std::string(header) + " " + coloured)).vertices[1], (Vec3{1, 0, 0}));
    expect_error(folder.write("m.off", "OFFX 3 1 0\n"), "does not start with OFF");
    expect_error(folder.write("m.off", "4OFF3 1 0\n"), "is not in three dimensions");
}

} // namespace
