// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/mesh/formats.h"
#include "tests/unit/mesh/load_error.h"
#include "tests/unit/mesh/solids.h"

#include <raycontact/error.h>
#include <raycontact/mesh.h>
#include <raycontact/settings.h>

#include <gtest/gtest.h>

#include <bit>
#include <clocale>
#include <cstdlib>
#include <locale>

using namespace raycontact;
using namespace raycontact::test;

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// Coordinates that float32 cannot hold.
Mesh odd_mesh() {
    Mesh mesh = torus(7, 5, 1.1, 0.3);
    mesh.vertices[3].x = 1.0 / 3;
    return mesh;
}

/// Thousands apart, a comma for a point: what a host program may set for all streams.
struct Grouped : std::numpunct<char> {
    char do_thousands_sep() const override { return '.'; }
    char do_decimal_point() const override { return ','; }
    std::string do_grouping() const override { return "\3"; }
};

void expect_equal(const Mesh& loaded, const Mesh& made) {
    EXPECT_EQ(loaded.vertices, made.vertices);
    EXPECT_EQ(loaded.triangles, made.triangles);
}

/// As STL has it: three vertices of its own for each triangle.
Mesh unwelded(const Mesh& mesh, bool as_float) {
    Mesh out;
    for (const auto& t : mesh.triangles) {
        const auto base = static_cast<std::uint32_t>(out.vertices.size());
        for (const std::uint32_t v : t) {
            out.vertices.push_back(as_float ? rounded(mesh.vertices[v]) : mesh.vertices[v]);
        }
        out.triangles.push_back({base, base + 1, base + 2});
    }
    return out;
}

TEST(Load, ObjKeepsIndicesAndEveryBit) {
    const TempFolder folder;
    const Mesh made = odd_mesh();
    const Mesh loaded = load_mesh(folder.write("a thing.OBJ", as_obj(made)));
    expect_equal(loaded, made);
    EXPECT_EQ(loaded.name, "a thing.OBJ");
}

TEST(Load, ObjFacesOfEveryKind) {
    const TempFolder folder;
    const Mesh mesh =
        load_mesh(folder.write("m.obj", "mtllib x.mtl\r\nv 0 0 0 1.0\r\nv +1 0 0\r\nv 1 1 0 0.5 0.5 0.5\r\n"
                                        "vt 0 0\r\nvn 0 0 1\r\nv 0 1 0 # corner\r\ng a b\r\ns off\r\n"
                                        "f 1/1/1 2//1 \\\r\n 3/1 4\r\nf -4 -3 -2\r\nf 1 2 5\r\nv 0 0 1e-400"));
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {0, 1, 4}}));
    EXPECT_EQ(mesh.vertices.size(), 5u);
    EXPECT_EQ(mesh.vertices[4], (Vec3{0, 0, 0}));
}

TEST(Load, ObjStatementsThatAreNotReadMayContinueOnTheNextLine) {
    const TempFolder folder;
    const Mesh mesh =
        load_mesh(folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 \\\n3\ng a \\\r\nb\n# no end \\\nf 1 2 3\n"));
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}}));
}

TEST(Load, NumbersHaveAPointInEveryLocale) {
    const TempFolder folder;
    const std::string make = "localedef -i de_DE -f UTF-8 " + (folder.path() / "comma").string();
    ASSERT_EQ(std::system(make.c_str()), 0) << "on Debian: apt-get install locales";
    ::setenv("LOCPATH", folder.path().c_str(), 1);
    ASSERT_NE(std::setlocale(LC_NUMERIC, "comma"), nullptr);
    const Mesh mesh = load_mesh(folder.write("m.obj", "v 1.5e-400 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
    std::setlocale(LC_NUMERIC, "C");
    ::unsetenv("LOCPATH");
    EXPECT_EQ(mesh.vertices[0], (Vec3{0, 0, 0}));
}

TEST(Load, NoTextOfOursFollowsTheHostsLocale) {
    const TempFolder folder;
    const auto texts = [&] {
        Mesh cube = box();
        for (Vec3& vertex : cube.vertices) vertex = {1234.5 * vertex.x, 0.25 * vertex.y, vertex.z};
        std::string all = to_text(prepare_mesh(cube).report) + to_json(prepare_mesh(cube).report);
        Mesh tiny = box();
        for (Vec3& vertex : tiny.vertices) vertex = {1.5e-9 * vertex.x, 1.5e-9 * vertex.y, 1.5e-9 * vertex.z};
        try {
            prepare_mesh(tiny);
        } catch (const InputError& error) {
            all += error.what();
        }
        Settings settings;
        settings.paper.confidence = 0.5;
        try {
            check_settings(settings);
        } catch (const InputError& error) {
            all += error.what();
        }
        return all;
    };
    const std::string classic = texts();
    EXPECT_NE(classic.find("0.5"), std::string::npos);
    const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Grouped));
    const std::string grouped = texts();
    std::locale::global(before);
    EXPECT_EQ(grouped, classic);

    const std::string make = "localedef -i de_DE -f UTF-8 " + (folder.path() / "comma").string();
    ASSERT_EQ(std::system(make.c_str()), 0) << "on Debian: apt-get install locales";
    ::setenv("LOCPATH", folder.path().c_str(), 1);
    ASSERT_NE(std::setlocale(LC_ALL, "comma"), nullptr);
    const std::string german = texts();
    std::setlocale(LC_ALL, "C");
    ::unsetenv("LOCPATH");
    EXPECT_EQ(german, classic);
}

TEST(Load, LinesMayEndInCarriageReturnAlone) {
    const TempFolder folder;
    const Mesh mesh = load_mesh(folder.write("m.obj", "\xef\xbb\xbfv 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r"));
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}}));
}

TEST(Load, OffKeepsIndicesAndEveryBit) {
    const TempFolder folder;
    const Mesh made = odd_mesh();
    expect_equal(load_mesh(folder.write("m.off", as_off(made))), made);
}

TEST(Load, OffWithColoursCommentsAndPolygons) {
    const TempFolder folder;
    const Mesh mesh =
        load_mesh(folder.write("m.off", "# first\nCOFF 4 2 0\n0 0 0 255 0 0 1\n1 0 0 0 0 0 1\n\n1 1 0 1 1 1 1 # x\n"
                                        "0 1 0 0 0 0 0\n4 0 1 2 3 0.5 0.5 0.5\n3 0 1 2\n"));
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}}));
}

TEST(Load, StlTextAndBinary) {
    const TempFolder folder;
    const Mesh made = odd_mesh();
    expect_equal(load_mesh(folder.write("t.stl", as_ascii_stl(made))), unwelded(made, false));
    expect_equal(load_mesh(folder.write("b.stl", as_binary_stl(made))), unwelded(made, true));
    const std::string two = as_ascii_stl(box()) + as_ascii_stl(box(2));
    EXPECT_EQ(load_mesh(folder.write("two.stl", two)).triangles.size(), 24u);
}

TEST(Load, PlyTextAndBothByteOrders) {
    const TempFolder folder;
    const Mesh made = odd_mesh();
    expect_equal(load_mesh(folder.write("t.ply", as_ascii_ply(made))), made);
    expect_equal(load_mesh(folder.write("l.ply", as_binary_ply(made, false))), made);
    expect_equal(load_mesh(folder.write("b.ply", as_binary_ply(made, true))), made);
}

TEST(Load, PlyOtherElementsPolygonsAndTypes) {
    const TempFolder folder;
    const Mesh mesh = load_mesh(folder.write(
        "m.ply",
        "ply\r\nformat ascii 1.0\r\nelement material 2\r\nproperty list uchar float parts\r\nproperty int id\r\n"
        "element vertex 4\r\nproperty float x\r\nproperty short y\r\nproperty float z\r\nelement face 1\r\n"
        "property uchar flags\r\nproperty list uint8 uint32 vertex_index\r\nelement edge 1\r\nproperty int a\r\n"
        "end_header\r\n2 0.5 nan 1\r\n0 2\r\n0 0 0\r\n1 0 0\r\n1 1 0\r\n0 1 0\r\n9 4 3 2 1 0\r\n5\r\n"));
    EXPECT_EQ(mesh.triangles, (Triangles{{3, 2, 1}, {3, 1, 0}}));
}

TEST(Load, PlyHeadersWithOddComments) {
    const TempFolder folder;
    const Mesh made = odd_mesh();
    for (const bool binary : {false, true}) {
        const std::string file = binary ? as_binary_ply(made) : as_ascii_ply(made);
        const auto with = [&](const std::string& before, const std::string& lines) {
            std::string changed = file;
            const std::size_t at = changed.find(before);
            EXPECT_NE(at, std::string::npos) << before;
            return changed.insert(at, lines);
        };
        for (const std::string& changed :
             {with("format ", "comment before the format\n"),
              with("element vertex", "obj_info\nobj_info x 1\n\n \t \n"),
              with("property double y", "comment\ncomment element face 9\n"),
              with("element face", "\tcomment\ttabs\t\n"), with("end_header", "comment the last\n"),
              with("end_header", "COMMENT in capitals\n"),
              with("end_header", "comment: with a colon\n#\n# as elsewhere\n"),
              with("element vertex", "Created by Blender3D 247 - www.blender.org, source file: \n"),
              with("element vertex", "comment a return alone\r\n"), with("\nelement face", " { number of faces }")}) {
            SCOPED_TRACE(changed.substr(0, 300));
            expect_equal(load_mesh(folder.write("m.ply", changed)), made);
        }
    }
    const std::string explained = // as the description of the format has it
        "ply\nformat ascii 1.0 { ascii/binary, format version number }\ncomment made by anonymous { comments }\n"
        "element vertex 3 { define \"vertex\" element, 3 of them in file }\nproperty float x { coordinate }\n"
        "property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_index\n"
        "end_header { delimits the end of the header }\n0 0 0 { start of vertex list }\n1 0 0\n0 1 0\n3 0 1 2 { a face "
        "}\n";
    EXPECT_EQ(load_mesh(folder.write("m.ply", explained)).triangles, (Triangles{{0, 1, 2}}));
}

TEST(Load, PlyHeadersWithEachLineEnd) {
    const TempFolder folder;
    Mesh made = box();
    made.vertices[0].x = std::bit_cast<double>(0x3fe0000000000d0aull); // the data begins with \n \r
    for (const bool big : {false, true}) {
        const std::string file = as_binary_ply(made, big);
        const std::size_t data = file.find("end_header\n") + 11;
        for (const char* end : {"\n", "\r", "\r\n"}) {
            std::string changed;
            for (const char c : file.substr(0, data)) changed += c == '\n' ? std::string(end) : std::string(1, c);
            expect_equal(load_mesh(folder.write("m.ply", changed + file.substr(data))), made);
        }
    }
}

/// With a byte order mark.
std::string utf16(const std::u16string& text, bool little) {
    std::string out;
    put(out, std::uint16_t{0xfeff}, !little);
    for (const char16_t c : text) put(out, static_cast<std::uint16_t>(c), !little);
    return out;
}
std::string utf16(const std::string& ascii, bool little) {
    return utf16(std::u16string(ascii.begin(), ascii.end()), little);
}

TEST(Load, TextInUtf16OrWithAByteOrderMark) {
    const TempFolder folder;
    const Mesh made = odd_mesh();
    const std::vector<std::pair<std::string, std::string>> files{
        {"m.obj", as_obj(made)}, {"m.off", as_off(made)}, {"m.ply", as_ascii_ply(made)}, {"m.stl", as_ascii_stl(made)}};
    for (const auto& [name, text] : files) {
        const Mesh wanted = load_mesh(folder.write(name, text));
        expect_equal(load_mesh(folder.write(name, utf16(text, true))), wanted);
        expect_equal(load_mesh(folder.write(name, utf16(text, false))), wanted);
        expect_equal(load_mesh(folder.write(name, "\xef\xbb\xbf" + text)), wanted);
        EXPECT_NE(error_of(folder.write(name, utf16(text, true) + "x")).find("odd number of bytes"), std::string::npos);
    }
    // Names that are not ASCII: two bytes, three, a pair, half of one.
    std::u16string named = {u'o', u' ', 0xe9, 0x20ac, 0xd83d, 0xde00, 0xd83d, u'\n'};
    for (const char c : as_obj(made)) named += static_cast<char16_t>(c);
    expect_equal(load_mesh(folder.write("m.obj", utf16(named, false))), made);
    expect_equal(load_mesh(folder.write("m.obj", utf16(named, true))), made);
    EXPECT_NE(error_of(folder.write("e.obj", utf16("v 0 0 0\nv 1 x 0\n", true))).find("e.obj: line 2: coordinate 'x'"),
              std::string::npos);
}

TEST(Load, ErrorsNameTheLineOrTheElement) {
    const TempFolder folder;
    EXPECT_NE(
        error_of(folder.write("a.obj", "v 0 0 0\nv 1 x 0\n")).find("a.obj: line 2: coordinate 'x' is not a number"),
        std::string::npos);
    EXPECT_NE(error_of(folder.write("b.obj", "v 0 0 0\nf 1 1 1\nf 1 1 9\n")).find("b.obj: line 3: vertex 9"),
              std::string::npos);
    EXPECT_NE(error_of(folder.write("c.off", "OFF 1 1 0\n0 0 0\n3 0 0 1\n")).find("c.off: line 3: vertex index 1"),
              std::string::npos);
    std::string ply = as_binary_ply(box());
    ply.resize(ply.size() - 13);
    EXPECT_NE(error_of(folder.write("d.ply", ply)).find("d.ply: element 'face'"), std::string::npos);
}

TEST(Load, AllFormatsOfOneMeshPrepareAlike) {
    const TempFolder folder;
    Mesh made = torus(9, 6, 1, 0.25);
    for (Vec3& v : made.vertices) v = rounded(v);
    const std::string wanted = to_json(prepare_mesh(made).report);
    const std::array files{folder.write("m.obj", as_obj(made)), folder.write("m.off", as_off(made)),
                           folder.write("m.ply", as_ascii_ply(made)), folder.write("b.ply", as_binary_ply(made)),
                           folder.write("m.glb", as_glb(made))};
    for (const auto& file : files) EXPECT_EQ(to_json(prepare_mesh(load_mesh(file)).report), wanted) << file;
    // STL alone has other counts of vertices in the file.
    for (const auto& file : {folder.write("m.stl", as_ascii_stl(made)), folder.write("b.stl", as_binary_stl(made))}) {
        MeshReport report = prepare_mesh(load_mesh(file)).report;
        EXPECT_EQ(report.file_vertices, 3 * made.triangles.size());
        report.file_vertices = made.vertices.size();
        EXPECT_EQ(to_json(report), wanted) << file;
    }
}

} // namespace
