// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/mesh/packages.h"
#include "tests/unit/mesh/solids.h"

#include "mesh/vector.h"

#include <raycontact/assembly.h>
#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include <gtest/gtest.h>

#include <map>

using namespace raycontact;
using namespace raycontact::test;

namespace {

Mesh load(const std::string& bytes) {
    return load_mesh(std::as_bytes(std::span(bytes)), MeshFormat::threemf, "m.3mf");
}
Mesh load_model(const std::string& model, const Parts& more = {}) {
    return load(zip_of(parts_3mf(model, more)));
}
std::vector<AssemblyPart> parts_of(const std::string& model, const Parts& more = {}) {
    const TempFolder folder;
    return load_assembly(folder.write("m.3mf", zip_of(parts_3mf(model, more))));
}

std::string error_of(const std::string& bytes) {
    try {
        load(bytes);
    } catch (const InputError& error) {
        const std::string line = error.what();
        EXPECT_TRUE(line.starts_with("m.3mf: ")) << line;
        EXPECT_EQ(line.find('\n'), std::string::npos) << line;
        EXPECT_LT(line.size(), 400u) << line;
        return line;
    }
    return "loaded";
}
void expect_error(const std::string& bytes, const std::string& what) {
    const std::string line = error_of(bytes);
    EXPECT_NE(line.find(what), std::string::npos) << line;
}
void expect_model_error(const std::string& model, const std::string& what, const Parts& more = {}) {
    expect_error(zip_of(parts_3mf(model, more)), what);
}

const std::string item = R"(<item objectid="1"/>)";

std::string box_object(const std::string& attributes = R"(id="1")") {
    return object_3mf(box(), attributes);
}
std::string assembly(int id, const std::string& components) {
    return R"(<object id=")" + std::to_string(id) + R"("><components>)" + components + "</components></object>\n";
}

TEST(Load3mf, KeepsIndicesAndEveryBit) {
    Mesh made = torus(7, 5, 1.1, 0.3);
    made.vertices[3].x = 1.0 / 3;
    const TempFolder folder;
    const Mesh loaded = load_mesh(folder.write("a thing.3MF", as_3mf(made)));
    EXPECT_EQ(loaded.vertices, made.vertices);
    EXPECT_EQ(loaded.triangles, made.triangles);
    EXPECT_EQ(loaded.name, "a thing.3MF");
    EXPECT_TRUE(loaded.repairs.empty());
    EXPECT_EQ(load(zip_of(parts_3mf(model_3mf(object_3mf(made, R"(id="1")"), item)), false)).vertices, made.vertices);
}

TEST(Load3mf, LengthsOfEveryUnitBecomeMetres) {
    const std::map<std::string, double> units = {{"", 0.001},
                                                 {R"(unit="micron")", 1e-6},
                                                 {R"(unit="millimeter")", 0.001},
                                                 {R"(unit="centimeter")", 0.01},
                                                 {R"(unit="inch")", 0.0254},
                                                 {R"(unit="foot")", 0.3048},
                                                 {R"(unit="meter")", 1}};
    for (const auto& [attribute, metres] : units) {
        SCOPED_TRACE(attribute);
        const std::string moved = R"(<item objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0 10"/>)";
        const Mesh mesh = load_model(model_3mf(box_object(), moved, attribute));
        EXPECT_EQ(mesh.vertices[1].x, metres);
        EXPECT_DOUBLE_EQ(mesh.vertices[0].z, 10 * metres);
    }
    expect_model_error(model_3mf(box_object(), item, R"(unit="yard")"), "line 2: unit 'yard' is unknown");
}

TEST(Load3mf, ATransformHasTheAxesInItsRows) {
    // x goes to y, y to -x
    const std::string build = R"(<item objectid="1" transform=" 0 1 0  -1 0 0 0 0 +1  5 6 7 "/>)";
    const Mesh mesh = load_model(model_3mf(box_object(), build));
    EXPECT_EQ(mesh.vertices[0], (Vec3{5, 6, 7}));
    EXPECT_EQ(mesh.vertices[1], (Vec3{5, 7, 7}));
    EXPECT_EQ(mesh.vertices[2], (Vec3{4, 6, 7}));
}

TEST(Load3mf, ItemsAndComponentsPlaceObjectsInOrder) {
    const std::string resources =
        box_object(R"(id="1" name="cube")") + object_3mf(torus(6, 4, 1, 0.3), R"(id="2")")
        + assembly(3, R"(<component objectid="1" transform="1 0 0 0 1 0 0 0 1 2 0 0"/><component objectid="2"/>)")
        + assembly(4, R"(<component objectid="3" transform="0 1 0 -1 0 0 0 0 1 0 0 0"/>)");
    const std::string build = R"(<item objectid="4" transform="1 0 0 0 1 0 0 0 1 0 0 5"/><item objectid="1"/>)";
    const Mesh mesh = load_model(model_3mf(resources, build));
    EXPECT_EQ(mesh.vertices.size(), 8u + 24 + 8);
    EXPECT_EQ(mesh.vertices[0], (Vec3{0, 2, 5})); // the cube, moved along x, then turned, then lifted
    EXPECT_EQ(mesh.vertices[1], (Vec3{0, 3, 5}));
    EXPECT_EQ(mesh.vertices[32], (Vec3{0, 0, 0})); // the second item
    EXPECT_EQ(mesh.triangles[12][0], torus(6, 4, 1, 0.3).triangles[0][0] + 8);

    const auto parts = parts_of(model_3mf(resources, build));
    ASSERT_EQ(parts.size(), 3u);
    EXPECT_EQ(parts[0].name, "cube");
    EXPECT_EQ(parts[1].name, "object 2");
    EXPECT_EQ(path_of(parts[1]), "object 4/object 3/object 2");
    EXPECT_EQ(path_of(parts[2]), "cube");
    EXPECT_EQ(parts[0].mesh, parts[2].mesh);
    EXPECT_EQ(parts[0].mesh->vertices, box().vertices);
    EXPECT_EQ(transform_point(parts[0].pose, {1, 0, 0}), (Vec3{0, 3, 5}));
    EXPECT_EQ(parts[2].pose, Pose{});
}

TEST(Load3mf, ScalesAndMirrorsGoIntoTheMesh) {
    const std::string build = R"(<item objectid="1" transform="2 0 0 0 2 0 0 0 2 1 0 0"/>)"
                              R"(<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 9"/>)"
                              R"(<item objectid="1" transform="2 0 0 0 2 0 0 0 2 7 0 0"/>)";
    const auto parts = parts_of(model_3mf(box_object(), build));
    ASSERT_EQ(parts.size(), 3u);
    EXPECT_EQ(parts[0].mesh, parts[2].mesh);
    EXPECT_NE(parts[0].mesh, parts[1].mesh);
    for (const auto& [part, volume] : {std::pair(parts[0], 8.0), std::pair(parts[1], 1.0)}) {
        const MeshReport report = prepare_mesh(*part.mesh).report;
        EXPECT_NEAR(report.volume, volume, 1e-12);
        EXPECT_TRUE(report.repairs.empty()); // a mirrored one winds outward, too
    }
    EXPECT_EQ(parts[0].pose.translation, (Vec3{1, 0, 0}));
    EXPECT_NEAR(prepare_mesh(load_model(model_3mf(box_object(), build))).report.volume, 17, 1e-9);
}

TEST(Load3mf, PartsInOtherFilesOfThePackageHaveTheirOwnUnit) {
    const Parts more{{"3D/Objects/one.model", model_3mf(box_object(R"(id="7" name="far")"), "", R"(unit="inch")")}};
    const std::string resources =
        assembly(1, R"(<component p:path="/3D/Objects/One.model" objectid="7" transform="1 0 0 0 1 0 0 0 1 0 1 0"/>)");
    const std::string model = model_3mf(resources, item + R"(<item objectid="7" p:path="/3D/Objects/one.model"/>)",
                                        R"(unit="millimeter" requiredextensions="p")");
    const auto parts = parts_of(model, more);
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_EQ(parts[0].name, "far");
    EXPECT_EQ(parts[0].mesh, parts[1].mesh);
    EXPECT_EQ(parts[0].mesh->vertices[1].x, 0.0254);
    EXPECT_EQ(parts[0].pose.translation, (Vec3{0, 0.001, 0}));
    expect_model_error(model, "has no part 3d/objects/one.model");
}

TEST(Load3mf, RefusesWhatItCannotReadByName) {
    const std::string beams = R"(xmlns:b="http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02" )";
    expect_model_error(model_3mf(box_object(), item, beams + R"(requiredextensions="b")"), "beamlattice/2017/02");
    expect_model_error(model_3mf(box_object(), item, R"(requiredextensions="p sc")"), "needs the extension 'sc'");
    const std::string only = R"(<object id="1"><b:booleanshape objectid="2"/></object>)";
    expect_model_error(model_3mf(only, item, beams), "object 1 is made of booleanshape of http://");
    // beside a mesh it is said
    std::string lattice = box_object();
    lattice.insert(lattice.find("</mesh>"), R"(<b:beamlattice radius="1"><b:beams/></b:beamlattice>)");
    const Mesh mesh = load_model(model_3mf(lattice, item, beams));
    ASSERT_EQ(mesh.repairs.size(), 1u);
    EXPECT_TRUE(mesh.repairs[0].starts_with("left out 1 x beamlattice of http://")) << mesh.repairs[0];
    EXPECT_EQ(prepare_mesh(mesh).report.repairs, mesh.repairs);
    // materials and sets of triangles are no surface
    std::string coloured = box_object(R"(id="1" pid="5" pindex="0")");
    coloured.insert(coloured.find("</mesh>"), R"(<t:trianglesets><t:triangleset/></t:trianglesets>)");
    const std::string extensions = R"(requiredextensions="m t" )"
                                   R"(xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02" )"
                                   R"(xmlns:t="http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07")";
    EXPECT_TRUE(load_model(model_3mf(R"(<m:colorgroup id="5"/>)" + coloured, item, extensions)).repairs.empty());
}

TEST(Load3mf, NamesObjectsThatTheBuildDoesNotPlaceAndThatHaveNothing) {
    const std::string nothing = R"(<object id="2" name="void"><mesh><vertices/><triangles/></mesh></object>)";
    const std::string model = model_3mf(box_object() + nothing + box_object(R"(id="3" name="spare")")
                                            + assembly(4, R"(<component objectid="1"/>)"),
                                        item + R"(<item objectid="2"/>)");
    const std::vector<std::string> expected{"left out 'spare', 'object 4': not in the build",
                                            "left out what has no triangles: 'void'"};
    const Mesh mesh = load_model(model);
    EXPECT_EQ(mesh.vertices, box().vertices);
    EXPECT_EQ(mesh.repairs, expected);
    const TempFolder folder;
    std::vector<std::string> left_out;
    EXPECT_EQ(load_assembly(folder.write("m.3mf", zip_of(parts_3mf(model))), &left_out).size(), 1u);
    EXPECT_EQ(left_out, expected);
    expect_model_error(model_3mf(box_object(), ""), "has no triangles (left out 'object 1': not in the build)");
    expect_model_error(model_3mf(nothing, R"(<item objectid="2"/>)"), "no triangles: 'void'); export a triangle mesh");
}

TEST(Load3mf, PackagesAsOtherProgramsZipThem) {
    const std::string model = model_3mf(box_object(), item);
    const auto with = [&](const std::string& old, const std::string& made, const std::string& name,
                          const std::string& content) {
        Parts parts = parts_3mf(content);
        std::string& relations = parts[0].second;
        relations.replace(relations.find(old), old.size(), made);
        parts[1].first = name;
        return load(zip_of(parts)).vertices;
    };
    const std::string target = R"("/3D/3dmodel.model")", name = "3D/3dmodel.model";
    EXPECT_EQ(with(target, R"("3D/Part 1.model")", "3D/Part 1.model", model), box().vertices);
    EXPECT_EQ(with(target, R"("/3d/3DMODEL.MODEL")", name, model), box().vertices);
    // A picture first.
    EXPECT_EQ(with("<Relationship Target", R"(<Relationship Target="/a.png" Id="a" Type="b"/><Relationship Target)",
                   name, model),
              box().vertices);
    EXPECT_EQ(with("", "", name, "\xef\xbb\xbf" + model), box().vertices);
    std::string wide = "\xff\xfe";
    for (const char c : model) wide += {c, '\0'};
    wide.replace(wide.find(std::string("U\0T\0F\0-\0008\0", 10)), 10, std::string("U\0T\0F\0-\0001\0006\0", 12));
    EXPECT_EQ(with("", "", name, wide), box().vertices);
    expect_error(zip_of({parts_3mf("")[0], {"3D/other.model", model}}), "has no part 3d/3dmodel.model");
}

TEST(Load3mf, RefusesDamagedModels) {
    const auto with = [](const std::string& object) { return model_3mf(object, item); };
    const auto changed = [&](const std::string& old, const std::string& made) {
        std::string object = box_object();
        return with(object.replace(object.find(old), old.size(), made));
    };
    expect_model_error(changed(R"(v1="0")", R"(v1="8")"), "line 16: vertex index 8 is not in 0 to 8 - 1");
    expect_model_error(changed(R"(v1="0")", R"(v1="-1")"), "v1 '-1' is not a whole number");
    expect_model_error(changed(R"(v1="0")", ""), "has no v1");
    expect_model_error(changed(R"(x="0")", R"(x="nan")"), "x 'nan' is not finite");
    expect_model_error(changed(R"(x="0")", R"(x="1e999")"), "x '1e999' is not finite");
    expect_model_error(changed(R"(x="0")", R"(x="1,5")"), "x '1,5' is not a number");
    expect_model_error(changed("</mesh>", ""), "is damaged: mismatched tag");
    expect_model_error(with(box_object() + box_object()), "object 1 is there twice");
    expect_model_error(model_3mf(box_object(), R"(<item objectid="2"/>)"), "object 2 does not exist");
    expect_model_error(model_3mf(box_object(), ""), "has no triangles");
    expect_model_error(model_3mf(box_object(), R"(<item objectid="1" transform="1 0 0"/>)"), "has 3 numbers, not 12");
    expect_model_error(with(assembly(1, item.substr(0, 0) + R"(<component objectid="1"/>)")),
                       "is a component of itself");
    expect_model_error(with(assembly(1, R"(<component objectid="2"/>)") + assembly(2, R"(<component objectid="1"/>)")),
                       "object 1 is a component of itself");
    expect_model_error("<html/>", "is no 3MF model: its root is 'html'");
    expect_model_error("<!DOCTYPE model [<!ENTITY a \"b\">]>" + box_object(), "declares a document type");
    expect_model_error(model_3mf(box_object(), item).substr(0, 400), "is damaged: ");
}

TEST(Load3mf, RefusesDamagedPackages) {
    const std::string sound = as_3mf(box());
    expect_error("no zip at all", "is no ZIP archive");
    expect_error(zip_of({{"a", "b"}}), "has no part _rels/.rels");
    expect_error(zip_of({{"_rels/.rels", "<Relationships/>"}}), "names no 3D model");
    Parts parts = parts_3mf("");
    parts.pop_back();
    expect_error(zip_of(parts), "has no part 3d/3dmodel.model");
    for (std::size_t size = 1; size < sound.size(); size += 7) EXPECT_NE(error_of(sound.substr(0, size)), "loaded");
    // in the directory, of the model: flags, method, checksum
    const std::size_t entry = sound.rfind("PK\1\2");
    const auto with_byte = [&](std::size_t at, int value) {
        std::string bytes = sound;
        bytes[at] = static_cast<char>(value);
        return bytes;
    };
    expect_error(with_byte(entry + 8, 1), "3d/3dmodel.model: is encrypted");
    expect_error(with_byte(entry + 10, 14), "is packed by method 14");
    expect_error(with_byte(entry + 16, sound[entry + 16] ^ 1), "is damaged in the ZIP archive");
}

TEST(Load3mf, BombsAreRefusedBeforeTheyFillTheMemory) {
    const std::string blank(66u << 20, ' ');
    expect_model_error(model_3mf(blank, item), "unpacks to more than 67108864 bytes");
    expect_model_error(model_3mf("<a b=\"" + std::string(3u << 20, 'x') + "\"/>", item), "has a tag of more than");
    std::string deep;
    for (int i = 0; i < 100; ++i) deep += "<a>";
    expect_model_error(model_3mf(deep, item), "lie more than 64 deep");
    // Each object is twice the one before it.
    std::string resources = box_object();
    for (int id = 2; id < 60; ++id) {
        const std::string before = R"(<component objectid=")" + std::to_string(id - 1) + R"("/>)";
        resources += assembly(id, before + before);
    }
    expect_model_error(model_3mf(resources, R"(<item objectid="59"/>)"), "places more than 65536 objects");
    expect_model_error(
        model_3mf(object_3mf(torus(100, 100, 1, 0.3), R"(id="1")") + resources.substr(box_object().size()),
                  R"(<item objectid="59"/>)"),
        "places the same meshes so often");
    std::string chain;
    for (int id = 2; id < 2000; ++id)
        chain += assembly(id, R"(<component objectid=")" + std::to_string(id - 1) + R"("/>)");
    expect_model_error(model_3mf(box_object() + chain, R"(<item objectid="1999"/>)"),
                       "lies more than 1000 components deep");
}

} // namespace
