// SPDX-License-Identifier: Apache-2.0
// `clash`: which parts of an assembly intersect, on cubes whose answers are known by hand.
#include "expect.h"

#ifdef RAYCONTACT_3MF
#include "tests/unit/mesh/packages.h"
#endif

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>

namespace {

using nlohmann::json;

class Clash : public testing::Test {
protected:
    /// An OBJ file of a cube of that edge about (x, 0, 0).
    void write_cube(const std::string& name, double x, double edge = 1) const {
        std::string text;
        for (int i = 0; i < 8; ++i) {
            const auto side = [&](int bit) { return (i >> bit & 1 ? 0.5 : -0.5) * edge; };
            text += "v ";
            for (const double c : {x + side(0), side(1), side(2)}) text += std::to_string(c) + " ";
            text += "\n";
        }
        text += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
        folder_.write(name, text);
    }

    /// A glTF file that places the cube of `cube.bin` at these x, under these names.
    void write_assembly(const std::string& name, const std::vector<std::pair<std::string, double>>& places) const {
        const std::vector<std::array<std::uint16_t, 3>> triangles{{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                                                                  {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                                                  {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
        std::string bytes;
        for (int i = 0; i < 8; ++i)
            for (int bit = 0; bit < 3; ++bit) {
                const float p = i >> bit & 1 ? 0.5f : -0.5f;
                bytes.append(reinterpret_cast<const char*>(&p), sizeof p);
            }
        bytes.append(reinterpret_cast<const char*>(triangles.data()), 72);
        folder_.write("cube.bin", bytes);
        json nodes = json::array();
        for (const auto& [node, x] : places) {
            json entry{{"mesh", 0}, {"translation", {x, 0, 0}}};
            if (!node.empty()) entry["name"] = node;
            nodes.push_back(entry);
        }
        std::vector<std::size_t> all(places.size());
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
        const json root{
            {"asset", {{"version", "2.0"}}},
            {"scene", 0},
            {"scenes", {{{"nodes", all}}}},
            {"nodes", nodes},
            {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}}},
            {"accessors",
             {{{"bufferView", 0}, {"componentType", 5126}, {"count", 8}, {"type", "VEC3"}},
              {{"bufferView", 1}, {"componentType", 5123}, {"count", 36}, {"type", "SCALAR"}}}},
            {"bufferViews",
             {{{"buffer", 0}, {"byteLength", 96}}, {{"buffer", 0}, {"byteOffset", 96}, {"byteLength", 72}}}},
            {"buffers", {{{"uri", "cube.bin"}, {"byteLength", 168}}}}};
        folder_.write(name, root.dump());
    }

    ProgramResult run(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "clash");
        return run_program(arguments, folder_.path());
    }
    /// The one clash that there is.
    json only_clash(const std::vector<std::string>& files) const {
        const auto found = clashes(files);
        EXPECT_EQ(found.size(), 1u);
        return found.empty() ? json::object() : found[0];
    }
    /// The clashes, one a line.
    std::vector<json> clashes(std::vector<std::string> arguments) const {
        arguments.emplace_back("--json");
        const ProgramResult result = run(arguments);
        EXPECT_EQ(result.status, 0) << result.err;
        return json_lines(result.out);
    }

    TemporaryFolder folder_;
};

TEST_F(Clash, DeepestFirstByFileName) {
    write_cube("a.obj", 0);
    write_cube("b.obj", 0.9);
    write_cube("c.obj", 1.6);
    write_cube("far.obj", 10);
    const ProgramResult result = run({"a.obj", "b.obj", "c.obj", "far.obj", "--json"});
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.err, "2 clashes among 4 parts (2 pairs of touching boxes)\n")
        << "boxes of a and c do not touch; no progress bar where nobody sees it";
    const auto found = json_lines(result.out);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(keys_of(found[0]),
              (std::set<std::string>{"a", "b", "path_a", "path_b", "depth", "point", "contacts", "duplicate", "normal",
                                     "kind", "distance", "point_a", "point_b", "open", "box"}));
    EXPECT_EQ(found[0]["a"], "b.obj");
    EXPECT_EQ(found[0]["b"], "c.obj");
    EXPECT_NEAR(found[0]["depth"].get<double>(), 0.3, 1e-5);
    EXPECT_NEAR(found[0]["point"][0].get<double>(), 1.25, 0.15 + 1e-5) << "in both";
    EXPECT_NEAR(found[0]["normal"][0].get<double>(), 1, 1e-6);
    EXPECT_GT(found[0]["contacts"], 0);
    EXPECT_EQ(found[0]["duplicate"], false);
    EXPECT_EQ(found[1]["a"], "a.obj");
    EXPECT_NEAR(found[1]["depth"].get<double>(), 0.1, 1e-5);
    EXPECT_NEAR(found[1]["point"][0].get<double>(), 0.45, 0.05 + 1e-5);

    const ProgramResult text = run({"a.obj", "b.obj", "c.obj", "far.obj"});
    EXPECT_EQ(text.status, 0);
    const std::string first = text.out.substr(0, text.out.find(','));
    EXPECT_NEAR(std::stod(first), 0.3, 1e-5) << first;
    EXPECT_NE(first.find(" m  b.obj  x  c.obj  at 1."), std::string::npos) << first;
    EXPECT_TRUE(text.out.ends_with("2 clashes among 4 parts (2 pairs of touching boxes)\n")) << text.out;
    EXPECT_EQ(text.err, "");
}

TEST_F(Clash, NodesOfAnAssembly) {
    write_assembly("all.gltf", {{"left", 0}, {"right", 0.9}, {"", 5}, {"left", 5.8}});
    write_cube("more.obj", 20);
    const auto found = clashes({"all.gltf", "more.obj"});
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0]["a"], "nodes[2]");
    EXPECT_EQ(found[0]["b"], "left #2");
    EXPECT_EQ(found[1]["a"], "left #1");
    EXPECT_EQ(found[1]["b"], "right");
}

TEST_F(Clash, TouchingPartsCanBeIgnored) {
    write_cube("a.obj", 0);
    write_cube("b.obj", 1);
    write_cube("c.obj", 1.9);
    const std::vector<std::string> files{"a.obj", "b.obj", "c.obj"};
    const auto all = clashes(files);
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all[1]["b"], "b.obj");
    EXPECT_EQ(all[1]["depth"], 0.0);
    EXPECT_EQ(all[1]["contacts"], 0);
    EXPECT_NEAR(all[1]["point"][0].get<double>(), 0.5, 1e-6) << "on the faces that touch";
    EXPECT_LE(std::fabs(all[1]["point"][1].get<double>()), 0.5 + 1e-6);
    EXPECT_NE(run(files).out.find("touching  a.obj  x  b.obj  at "), std::string::npos);

    const auto crossing = clashes({"a.obj", "b.obj", "c.obj", "--ignore-touching", "0"});
    ASSERT_EQ(crossing.size(), 1u);
    EXPECT_EQ(crossing[0]["b"], "c.obj");
    const ProgramResult none = run({"a.obj", "b.obj", "c.obj", "--ignore-touching", "0.2", "--json"});
    EXPECT_EQ(none.out, "");
    EXPECT_NE(none.err.find("0 clashes among 3 parts (2 pairs of touching boxes), 2 ignored as touching"),
              std::string::npos);
}

TEST_F(Clash, OneInsideAnother) {
    write_cube("box.obj", 0);
    write_cube("hidden.obj", 0.1, 0.2);
    const json found = only_clash({"box.obj", "hidden.obj"});
    EXPECT_GT(found["depth"].get<double>(), 0.2);
}

TEST_F(Clash, SeparationsAreToldWhereAsked) {
    write_cube("a.obj", 0);
    write_cube("b.obj", 0.75);
    write_cube("on it.obj", -1);
    const auto found = clashes({"a.obj", "b.obj", "on it.obj", "--separation"});
    ASSERT_EQ(found.size(), 2u);
    const json& parted = found[0]["separation"];
    EXPECT_EQ(keys_of(parted), (std::set<std::string>{"distance", "normal", "point_a", "point_b"}));
    EXPECT_NEAR(parted["distance"].get<double>(), -0.25, 1e-4);
    EXPECT_NEAR(parted["normal"][0].get<double>(), 1, 1e-6);
    EXPECT_NEAR(parted["point_a"][0].get<double>(), 0.5, 1e-6);
    EXPECT_TRUE(found[1]["separation"].is_null()) << "they touch";
    const std::string text = run({"a.obj", "b.obj", "--separation", "--unit", "mm", "--csv", "parted.csv"}).out;
    EXPECT_NE(text.find("  (parted by 0.25"), std::string::npos) << text;
    EXPECT_NE(text.find(" mm along 1, 0, 0)\n"), std::string::npos) << text;
    std::ifstream file(folder_.path() / "parted.csv", std::ios::binary);
    EXPECT_NE(std::string(std::istreambuf_iterator<char>(file), {}).find(",,-0.25"), std::string::npos);
}

TEST_F(Clash, TheSamePartTwice) {
    write_assembly("all.gltf", {{"p", 0}, {"p", 0}});
    const json found = only_clash({"all.gltf"});
    EXPECT_EQ(found["a"], "p #1");
    EXPECT_EQ(found["duplicate"], true);
    EXPECT_NEAR(found["depth"].get<double>(), 1, 1e-5) << "a whole part deep, not next to nothing";
    EXPECT_NE(run({"all.gltf"}).out.find("(the same part in the same place)"), std::string::npos);
}

TEST_F(Clash, ACopyWithItsVerticesInAnotherOrderOrTurnedIsADuplicate) {
    write_cube("a.obj", 3);
    folder_.write("b.obj", "v 3.5 .5 .5\nv 2.5 .5 .5\nv 3.5 -.5 .5\nv 2.5 -.5 .5\nv 3.5 .5 -.5\nv 2.5 .5 -.5\n"
                           "v 3.5 -.5 -.5\nv 2.5 -.5 -.5\n"
                           "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n");
    const json found = only_clash({"a.obj", "b.obj"});
    EXPECT_EQ(found["duplicate"], true);
    EXPECT_NEAR(found["depth"].get<double>(), 1, 1e-5);
}

TEST_F(Clash, PartsWhoseFacesCoincideHaveTheirDepth) {
    write_cube("cube.obj", 0);
    // The same cube with one corner cut off: another mesh in the same place.
    folder_.write("cut.obj", "v -.5 -.5 -.5\nv .5 -.5 -.5\nv -.5 .5 -.5\nv .5 .5 -.5\nv -.5 -.5 .5\nv .5 -.5 .5\n"
                             "v -.5 .5 .5\nv .3 .5 .5\nv .5 .3 .5\nv .5 .5 .3\n"
                             "f 1 3 4 2\nf 5 6 9 8 7\nf 1 2 6 5\nf 3 7 8 10 4\nf 1 5 7 3\nf 2 4 10 9 6\nf 8 9 10\n");
    const json found = only_clash({"cube.obj", "cut.obj"});
    EXPECT_EQ(found["duplicate"], false);
    EXPECT_GT(found["depth"].get<double>(), 0.5);
}

// Less than 1e-6 of the size is rounding; what is more has its depth, down to the coordinates' own.
TEST_F(Clash, ShallowOverlapsHaveTheirDepth) {
    write_cube("a.obj", 0);
    for (const double overlap : {1e-2, 1e-3, 1e-4, 1e-5}) {
        write_cube("b.obj", 1 - overlap);
        const json found = only_clash({"a.obj", "b.obj"});
        EXPECT_NEAR(found["depth"].get<double>(), overlap, 1e-6);
        EXPECT_GT(found["contacts"], 0) << overlap;
    }
    write_cube("b.obj", 0.7 - 1e-5, 0.4); // no face of it coincides with one of a
    const json smaller = only_clash({"a.obj", "b.obj"});
    EXPECT_NEAR(smaller["depth"].get<double>(), 1e-5, 1e-6);
    EXPECT_NEAR(smaller["normal"][0].get<double>(), 1, 1e-6);
}

TEST_F(Clash, OpenPartsThatCrossAreAsDeepAsOneIsBehindTheOther) {
    folder_.write("lying.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
    folder_.write("upright.obj", "v -.5 0.1 -.3\nv .5 0.1 -.3\nv .5 0.1 1\nv -.5 0.1 1\nf 1 2 3 4\n");
    const ProgramResult result = run({"lying.obj", "upright.obj", "--ignore-touching", "0", "--check", "--json"});
    EXPECT_EQ(result.status, 3);
    const auto found = json_lines(result.out);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0]["depth"].get<double>(), 0.3, 1e-5);
    EXPECT_EQ(found[0]["contacts"], 2);
    EXPECT_EQ(found[0]["kind"], "overlapping");
    EXPECT_EQ(found[0]["open"], json({"a", "b"}));
    EXPECT_NE(result.err.find("open, so that nothing is inside: lying.obj, upright.obj"), std::string::npos);
}

TEST_F(Clash, OpenPartsBehindEachOtherAreNoClash) {
    folder_.write("tent.obj", "v 0 0 1\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\nf 1 4 5\nf 1 5 2\n");
    folder_.write("sheet.obj", "v -.1 -.1 .2\nv .1 -.1 .2\nv .1 .1 .2\nv -.1 .1 .2\nf 4 3 2 1\n");
    const ProgramResult result = run({"tent.obj", "sheet.obj"});
    EXPECT_EQ(result.status, 0);
    EXPECT_NE(result.out.find("0 clashes among 2 parts (1 pair of touching boxes)"), std::string::npos) << result.out;
    // They do have contacts: a vertex of one sees the other from behind.
    const ProgramResult pair = run_program({"collide", "tent.obj", "sheet.obj"}, folder_.path());
    EXPECT_NE(pair.out.find(": apart by "), std::string::npos) << pair.out;
    EXPECT_NE(pair.out.find(" of open meshes, each behind the other, deepest "), std::string::npos) << pair.out;
    const json line = json::parse(run_program({"collide", "tent.obj", "sheet.obj", "--json"}, folder_.path()).out);
    EXPECT_EQ(line["colliding"], true);
    EXPECT_EQ(line["intersecting"], false);
}

TEST_F(Clash, NamesAreUnique) {
    write_assembly("all.gltf", {{"bolt", 0}, {"bolt", 0.5}, {"bolt #1", 1}, {"", 1.4}});
    std::filesystem::create_directory(folder_.path() / "other");
    write_cube("part.obj", 1.8);
    write_cube("other/part.obj", 2.2);
    std::set<std::string> names;
    for (const auto& clash : clashes({"all.gltf", "part.obj", "other/part.obj"}))
        names.insert({clash["a"].get<std::string>(), clash["b"].get<std::string>()});
    EXPECT_EQ(names,
              (std::set<std::string>{"bolt #2", "bolt #3", "bolt #1", "nodes[3]", "part.obj", "other/part.obj"}));
}

TEST_F(Clash, PartsAreSplitIntoTheirComponents) {
    write_cube("one.obj", 0);
    std::ostringstream two;
    for (const double x : {0.0, 0.9}) {
        for (int i = 0; i < 8; ++i)
            two << "v " << x + (i & 1) - 0.5 << ' ' << (i >> 1 & 1) - 0.5 << ' ' << (i >> 2 & 1) - 0.5 << '\n';
        two << "f -8 -6 -5 -7\nf -4 -3 -1 -2\nf -8 -7 -3 -4\nf -6 -2 -1 -5\nf -8 -4 -2 -6\nf -7 -5 -1 -3\n";
    }
    folder_.write("two.obj", two.str());
    expect_refused(run({"two.obj"}), "--components splits parts further");
    const json found = only_clash({"two.obj", "--components"});
    EXPECT_EQ(found["a"], "two.obj #1");
    EXPECT_EQ(found["b"], "two.obj #2");
    EXPECT_NEAR(found["depth"].get<double>(), 0.1, 1e-5);
    EXPECT_EQ(clashes({"two.obj", "one.obj", "--components", "--against", "one.obj"}).size(), 2u);
    expect_refused(run({"one.obj", "--components"}), "--components finds one part");
}

TEST_F(Clash, FittedCopiesOnlyTouch) {
    const auto write_prism = [&](const std::string& name, const std::vector<std::array<double, 2>>& outline) {
        std::ostringstream text, low, high;
        for (const double z : {0.0, 1.0})
            for (const auto& [x, y] : outline) text << "v " << x << ' ' << y << ' ' << z << '\n';
        const std::size_t n = outline.size();
        for (std::size_t i = 1; i <= n; ++i) {
            const std::size_t next = i % n + 1;
            text << "f " << i << ' ' << next << ' ' << n + next << ' ' << n + i << '\n';
            low << ' ' << n + 1 - i;
            high << ' ' << n + i;
        }
        folder_.write(name, text.str() + "f" + low.str() + "\nf" + high.str() + "\n");
    };
    write_prism("l.obj", {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
    write_prism("turned.obj", {{3, 2}, {1, 2}, {1, 1}, {2, 1}, {2, 0}, {3, 0}});
    const json found = only_clash({"l.obj", "turned.obj"});
    EXPECT_EQ(found["depth"], 0.0);
    EXPECT_EQ(found["duplicate"], false);
}

TEST_F(Clash, CheckIsForScripts) {
    write_cube("a.obj", 0);
    write_cube("b.obj", 0.9);
    write_cube("far.obj", 10);
    EXPECT_EQ(run({"a.obj", "b.obj", "--check"}).status, 3);
    EXPECT_EQ(run({"a.obj", "far.obj", "--check"}).status, 0);
    EXPECT_EQ(run({"a.obj", "b.obj", "--check", "--ignore-touching", "0.2"}).status, 0);
}

TEST_F(Clash, APartThatCannotBeTestedIsNamed) {
    write_cube("a.obj", 0);
    write_cube("tiny.obj", 0, 1e-7);
    const ProgramResult result = run({"a.obj", "tiny.obj"});
    EXPECT_EQ(result.status, 0);
    EXPECT_NE(result.err.find("not checked: tiny.obj: "), std::string::npos) << result.err;
    EXPECT_NE(result.out.find("; 1 part was not checked"), std::string::npos) << result.out;
    EXPECT_EQ(run({"a.obj", "tiny.obj", "--check"}).status, 1) << "nothing passes untested";
}

TEST_F(Clash, ColouredAssembly) {
    write_assembly("all.gltf", {{"left", 1000}, {"right", 1000.9}, {"alone", 1005}});
    const ProgramResult result = run({"all.gltf", "--out", "red.glb", "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    std::ifstream file(folder_.path() / "red.glb", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    std::uint32_t size = 0;
    std::memcpy(&size, &bytes.at(12), 4);
    const json root = json::parse(bytes.substr(20, size));
    ASSERT_EQ(root["nodes"].size(), 4u);
    const auto material = [&](int node) -> json {
        return root["meshes"][root["nodes"][node]["mesh"].get<std::size_t>()]["primitives"][0]["material"];
    };
    EXPECT_EQ(material(0), 0);
    EXPECT_EQ(material(1), 0);
    EXPECT_EQ(material(2), 1);
    EXPECT_EQ(root["bufferViews"].size(), 2u) << "one mesh, written once";
    EXPECT_EQ(root["nodes"][3]["name"], "left x right");
    EXPECT_NEAR(root["nodes"][3]["translation"][0].get<double>(), 1000.45, 0.051);
    const auto again = clashes({"red.glb"}); // it is an assembly, too
    ASSERT_EQ(again.size(), 1u);
    EXPECT_EQ(again[0]["a"], "left");
}

TEST_F(Clash, AgainstExcludeAndClearance) {
    write_assembly("all.gltf", {{"pipe, 1", 0}, {"pipe, 2", 0.9}, {"wall", 1.8}, {"post", 2.85}});
    const auto pairs = [&](std::vector<std::string> options) {
        options.insert(options.begin(), "all.gltf");
        std::set<std::string> found;
        for (const json& c : clashes(options))
            found.insert(c["a"].get<std::string>() + "-" + c["b"].get<std::string>() + " "
                         + c["kind"].get<std::string>());
        return found;
    };
    using Found = std::set<std::string>;
    const std::string first = "pipe, 1-pipe, 2 overlapping", second = "pipe, 2-wall overlapping";
    EXPECT_EQ(pairs({}), (Found{first, second}));
    EXPECT_EQ(pairs({"--clearance", "0.06"}), (Found{first, second, "wall-post near"}));
    EXPECT_EQ(pairs({"--tolerance", "0.06"}), (Found{first, second, "wall-post touching"}));
    EXPECT_EQ(pairs({"--tolerance", "0.11"}),
              (Found{"pipe, 1-pipe, 2 touching", "pipe, 2-wall touching", "wall-post touching"}));
    EXPECT_EQ(pairs({"--against", "wall"}), (Found{second}));
    EXPECT_EQ(pairs({"--against", "pipe*"}), (Found{second}));
    folder_.write("known.csv", "# agreed\n\"pipe, 2\",wal?\r\n\n");
    EXPECT_EQ(pairs({"--exclude", "known.csv"}), (Found{first}));
    folder_.write("everything.csv", "*,*\n");
    EXPECT_EQ(pairs({"--exclude", "everything.csv"}), Found{});
    EXPECT_EQ(run({"all.gltf", "--exclude", "everything.csv", "--check"}).status, 0);
    EXPECT_EQ(run({"all.gltf", "--exclude", "everything.csv", "--clearance", "9", "--check"}).status, 0);
    EXPECT_EQ(run({"all.gltf", "--against", "post", "--clearance", "0.06", "--check"}).status, 3);
    EXPECT_EQ(pairs({"--clearance", "0.06", "--ignore-touching", "1"}), (Found{"wall-post near"}));
    const auto near = [&](std::vector<std::string> options) {
        Found found = pairs(std::move(options));
        std::erase_if(found, [](const std::string& words) { return !words.ends_with(" near"); });
        return found;
    };
    EXPECT_EQ(near({"--clearance", "0.06:wall"}), (Found{"wall-post near"}));
    EXPECT_EQ(near({"--clearance", "0.06:pipe*"}), Found{});
    EXPECT_EQ(near({"--clearance", "0.06:post:w*", "--clearance", "0.01"}), (Found{"wall-post near"}));
    EXPECT_EQ(near({"--clearance", "0.06:post:pipe*", "--clearance", "0.01"}), Found{});
    EXPECT_EQ(near({"--clearance", "60mm:wall", "--unit", "m"}), (Found{"wall-post near"}));
    EXPECT_EQ(near({"--clearance", "40mm", "--unit", "m"}), Found{});
    EXPECT_EQ(near({"--clearance", "1e-3in", "--clearance", "6cm", "--unit", "m"}), (Found{"wall-post near"}));
    for (const auto& [word, why] : {std::pair{"60mm", "--unit"},
                                    {"x:wall", "--clearance"},
                                    {"0.06:", "pattern"},
                                    {"0.06:wall:", "pattern"},
                                    {"0.06ft", "--clearance"},
                                    {"0.06:walls", "walls"},
                                    {"1e10", "--clearance"},
                                    {"", "--clearance"},
                                    {"-1:wall", "--clearance"}})
        expect_refused(run({"all.gltf", std::string("--clearance=") + word}), why);
    const ProgramResult text = run({"all.gltf", "--clearance", "60", "--unit", "mm"});
    EXPECT_NE(text.out.find(" mm apart  wall  x  post  at 2.3"), std::string::npos) << text.out;
    EXPECT_EQ(clashes({"all.gltf", "--unit", "in"})[0]["unit"], "in");
}

#ifdef RAYCONTACT_3MF
// A 3MF says its unit, an OBJ does not: the one comes to the unit of the other, and its place with it.
TEST_F(Clash, PartsOf3mfComeToTheUnitOfTheOthers) {
    raycontact::Mesh box;
    for (int i = 0; i < 8; ++i) box.vertices.push_back({i & 1 ? 5.0 : -5.0, i & 2 ? 5.0 : -5.0, i & 4 ? 5.0 : -5.0});
    box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                     {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    using namespace raycontact::test;
    folder_.write("b.3MF", zip_of(parts_3mf(model_3mf(object_3mf(box, R"(id="1")"),
                                                      R"(<item objectid="1" transform="1 0 0 0 1 0 0 0 1 9 0 0"/>)",
                                                      R"(unit="millimeter")"))));
    write_cube("a.obj", 0, 10);
    const auto found = clashes({"a.obj", "b.3MF", "--unit", "mm"});
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0]["depth"].get<double>(), 1, 1e-5);
    EXPECT_NEAR(found[0]["box"][0][0].get<double>(), 4, 1e-5);
    write_cube("a.obj", 0, 1);
    const auto in_cm = clashes({"a.obj", "b.3MF", "--unit", "cm"});
    ASSERT_EQ(in_cm.size(), 1u);
    EXPECT_NEAR(in_cm[0]["depth"].get<double>(), 0.1, 1e-6);
    EXPECT_TRUE(clashes({"a.obj", "b.3MF"}).size() == 1) << "in metres the small one lies in the large one";
}
#endif

TEST_F(Clash, PartsUnderOtherParts) {
    write_assembly("all.gltf", {{"pump", 0}, {"flange", 0.9}, {"bolt", 0.9}, {"group", 5}});
    std::ifstream file(folder_.path() / "all.gltf");
    json root = json::parse(file);
    root["nodes"][3].erase("mesh");
    root["nodes"][3]["translation"] = {0, 0, 0};
    root["nodes"][0]["children"] = {1, 3}; // the bolt under the pump, too, by way of a node without a mesh
    root["nodes"][3]["children"] = {2};
    root["scenes"][0]["nodes"] = {0};
    folder_.write("tree.gltf", root.dump());
    EXPECT_EQ(clashes({"tree.gltf"}).size(), 3u);
    const json found = only_clash({"tree.gltf", "--exclude", "parent-child"});
    EXPECT_EQ(found["a"], "flange");
    EXPECT_EQ(found["b"], "bolt");
    EXPECT_EQ(found["kind"], "duplicate");

    // Nodes without a mesh are told, too: in paths, which patterns match, and as a tree.
    EXPECT_EQ(found["path_a"], "pump/flange");
    EXPECT_EQ(found["path_b"], "pump/group/bolt");
    EXPECT_EQ(clashes({"tree.gltf", "--against", "group/*"}).size(), 2u);
    EXPECT_EQ(clashes({"tree.gltf", "--against", "pump/*"}).size(), 2u) << "not the pump itself";
    EXPECT_NE(run({"tree.gltf"}).out.find("  pump/flange  x  pump/group/bolt  at "), std::string::npos);
    EXPECT_EQ(run({"tree.gltf", "--tree"}).out, "pump  (12 triangles)\n"
                                                "pump/\n"
                                                "  flange  (12 triangles)\n"
                                                "  group/\n"
                                                "    bolt  (12 triangles)\n");
    expect_refused(run({"tree.gltf", "--tree", "--check"}), "--tree");
    write_cube("post.obj", 1.8);
    EXPECT_EQ(run({"tree.gltf", "post.obj", "--tree"}).out, "tree.gltf/\n"
                                                            "  pump  (12 triangles)\n"
                                                            "  pump/\n"
                                                            "    flange  (12 triangles)\n"
                                                            "    group/\n"
                                                            "      bolt  (12 triangles)\n"
                                                            "post.obj  (12 triangles)\n");
    const auto lines = json_lines(run({"tree.gltf", "post.obj", "--tree", "--json"}).out);
    ASSERT_EQ(lines.size(), 4u);
    EXPECT_EQ(lines[2]["path"], "tree.gltf/pump/group/bolt");
    EXPECT_EQ(lines[2]["under"], (json{"tree.gltf", "pump", "group"}));
    EXPECT_EQ(clashes({"tree.gltf", "post.obj", "--against", "tree.gltf/*"}).size(), 2u);
    // A name that two files have gets its file; paths tell that once.
    std::ofstream(folder_.path() / "more.gltf") << root.dump();
    const json again = json_lines(run({"tree.gltf", "more.gltf", "--tree", "--json"}).out)[5];
    EXPECT_EQ(again["name"], "more.gltf:bolt");
    EXPECT_EQ(again["path"], "more.gltf/pump/group/bolt");
}

TEST_F(Clash, Table) {
    write_cube("a.obj", 0);
    write_cube("b, \"2\".obj", 0.75);
    write_cube("touch.obj", -1);
    ASSERT_EQ(run({"a.obj", "b, \"2\".obj", "touch.obj", "--csv", "out.csv", "--volume", "--unit", "mm"}).status, 0);
    std::ifstream file(folder_.path() / "out.csv", std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    EXPECT_TRUE(text.starts_with("a,b,kind,depth,distance,x,y,z,contacts,open,low_x,")) << text;
    EXPECT_NE(text.find("\r\na.obj,\"b, \"\"2\"\".obj\",overlapping,0.249"), std::string::npos) << text;
    EXPECT_NE(text.find(",volume,separation,unit\r\n"), std::string::npos) << text;
    EXPECT_NE(text.find(",0.25,,mm\r\na.obj,touch.obj,touching,0,0,-0.5,"), std::string::npos) << text;
    EXPECT_TRUE(text.ends_with(",0,,,,,,,,,,mm\r\n")) << text;
    ASSERT_EQ(run({"a.obj", "touch.obj", "--csv", "out.csv"}).status, 0);
    std::ifstream untold(folder_.path() / "out.csv", std::ios::binary);
    const std::string without{std::istreambuf_iterator<char>(untold), {}};
    EXPECT_TRUE(without.ends_with(",0,,,,,,,,,,\r\n")) << without;
}

TEST_F(Clash, GroupsOfClashes) {
    write_assembly("all.gltf", {{"flange", 0}, {"bolt", 0.9}, {"bolt", -0.8}, {"post", 1.75}, {"node", 0}, {"far", 9}});
    std::ifstream file(folder_.path() / "all.gltf");
    json root = json::parse(file);
    root["nodes"][4].erase("mesh");
    root["nodes"][4]["children"] = {1, 2};
    root["scenes"][0]["nodes"] = {0, 3, 4, 5};
    folder_.write("all.gltf", root.dump());
    const auto groups = clashes({"all.gltf", "--group", "part", "--unit", "m"});
    ASSERT_EQ(groups.size(), 2u);
    EXPECT_EQ(keys_of(groups[0]), (std::set<std::string>{"a", "b", "count", "box", "clashes"}));
    EXPECT_EQ(groups[0]["a"], "flange");
    EXPECT_TRUE(groups[0]["b"].is_null());
    EXPECT_EQ(groups[0]["count"], 2);
    EXPECT_EQ(groups[0]["clashes"][0]["b"], "bolt #2") << "the deepest first";
    EXPECT_NEAR(groups[0]["box"][0][0].get<double>(), -0.5, 1e-5);
    EXPECT_NEAR(groups[0]["box"][1][0].get<double>(), 0.5, 1e-5);
    EXPECT_EQ(groups[1]["a"], "node/bolt #1");
    EXPECT_EQ(groups[1]["b"], "post");
    EXPECT_EQ(groups[1]["clashes"][0], clashes({"all.gltf", "--unit", "m"})[1]);

    const ProgramResult text = run({"all.gltf", "--group", "assembly", "--csv", "groups.csv"});
    EXPECT_NE(text.out.find("  flange  x  node  2 clashes, in -0.5"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("  node  x  post  1 clash, in 1.2"), std::string::npos) << text.out;
    EXPECT_TRUE(text.out.ends_with("3 clashes among 5 parts (3 pairs of touching boxes) in 2 groups\n")) << text.out;
    std::ifstream table(folder_.path() / "groups.csv", std::ios::binary);
    const std::string lines{std::istreambuf_iterator<char>(table), {}};
    EXPECT_NE(lines.find(",unit,group\r\n"), std::string::npos) << lines;
    EXPECT_TRUE(lines.ends_with(",,1\r\n") || lines.ends_with(",,2\r\n")) << lines;
    EXPECT_EQ(clashes({"all.gltf", "--group", "part", "--ignore-touching", "0.12"})[0]["count"], 1);
    EXPECT_EQ(clashes({"all.gltf", "--group", "1"})[0]["b"], "node");
    for (const char* bad : {"0", "parts", "-1", ""})
        expect_refused(run({"all.gltf", std::string("--group=") + bad}), "--group");
}

TEST_F(Clash, SameForEveryNumberOfThreads) {
    std::vector<std::string> arguments;
    for (int i = 0; i < 40; ++i) {
        arguments.push_back(std::to_string(i) + ".obj");
        write_cube(arguments.back(), 0.37 * (i * 7 % 40), 0.3 + 0.02 * (i % 11));
    }
    arguments.insert(arguments.end(), {"--threads", "1"});
    const auto one = clashes(arguments);
    EXPECT_GT(one.size(), 20u);
    arguments.back() = "4";
    EXPECT_EQ(clashes(arguments), one);
}

TEST_F(Clash, BadInputIsRefused) {
    write_cube("a.obj", 0);
    expect_refused(run({"a.obj", "missing.glb"}), "missing.glb");
    expect_refused(run({"a.obj", "--ignore-touching", "-1"}), "--ignore-touching");
    expect_refused(run({"a.obj", "--threads", "many"}), "--threads");
    expect_refused(run({"a.obj", "--out", "a.obj/red.glb"}), "a.obj/red.glb: cannot be written: its folder cannot be");
    folder_.write("empty.gltf", R"({"asset": {"version": "2.0"}})");
    expect_refused(run({"empty.gltf"}), "empty.gltf");
    expect_refused(run({"a.obj"}), "is one part");
    write_cube("b.obj", 0);
    expect_refused(run({"a.obj", "b.obj", "--out", "b.obj"}), "ends in .glb");
    expect_refused(run({"a.obj", "b.obj", "--csv", "b.txt"}), "ends in .csv");
    expect_refused(run({"a.obj", "b.obj", "--bcf", "b.zip", "--unit", "m"}), "ends in .bcfzip");
    expect_refused(run({"a.obj", "b.obj", "--bcf", "b.bcfzip"}), "give --unit m, mm, cm or in");
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "b.bcfzip"));
    expect_refused(run({"a.obj", "b.obj", "--clearance", "-1"}), "--clearance");
    expect_refused(run({"a.obj", "b.obj", "--tolerance", "-1"}), "--tolerance");
    expect_refused(run({"a.obj", "b.obj", "--unit", "ft"}), "--unit");
    expect_refused(run({"a.obj", "b.obj", "--against", "c*"}), "\"c*\"");
    expect_refused(run({"a.obj", "b.obj", "--against", "*"}), "all parts match");
    expect_refused(run({"a.obj", "b.obj", "--exclude", "none.csv"}), "none.csv");
    folder_.write("pairs.csv", "a.obj,b.obj\na.obj,c.obj\n");
    expect_refused(run({"a.obj", "b.obj", "--exclude", "pairs.csv"}), "exclude, pair 2: no part and no file is called");
    folder_.write("pairs.csv", "a.obj,b.obj\na.obj\n");
    expect_refused(run({"a.obj", "b.obj", "--exclude", "pairs.csv"}), "pairs.csv:2");
    write_assembly("two.gltf", {{"p", 0}, {"q", 0}});
    ASSERT_EQ(run({"two.gltf", "--out", "two.glb"}).status, 0);
    EXPECT_EQ(run({"two.gltf", "--out", "a/new/folder/two.glb"}).status, 0);
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "a/new/folder/two.glb"));
    expect_refused(run({"two.glb", "--out", "two.glb"}), "one of the files to read");
    folder_.write("text.glb", "no mesh");
    expect_refused(run({"text.glb"}), "text.glb");
    EXPECT_EQ(run({}).status, 2);
}

TEST_F(Clash, WhatAFileHasBesidesPartsIsNamed) {
    write_assembly("hidden.gltf", {{"lid", 0}, {"bolt", 0.7}, {"nut", 5}});
    std::ifstream file(folder_.path() / "hidden.gltf");
    json root = json::parse(file);
    root["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = false;
    root["scenes"][0]["nodes"] = {0, 1};
    folder_.write("hidden.gltf", root.dump());
    write_cube("a.obj", 0);
    const auto result = run({"hidden.gltf", "a.obj", "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_TRUE(result.err.starts_with("hidden.gltf: left out 'lid': hidden (KHR_node_visibility)\n"
                                       "hidden.gltf: left out 'nut': not in the scene\n"))
        << result.err;
    const auto lines = json_lines(result.out);
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_EQ(lines[0]["a"], "bolt");
    EXPECT_EQ(lines[0]["b"], "a.obj");
}

TEST_F(Clash, InstancesObjectsAndSolidsAreParts) {
    write_assembly("three.gltf", {{"bolt", 10}});
    std::ifstream file(folder_.path() / "three.gltf");
    json root = json::parse(file);
    // Moved by three corners of the cube: the first two overlap by none, as they share a face alone.
    root["accessors"].push_back({{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
    root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = 2;
    folder_.write("three.gltf", root.dump());
    const auto of_instances = json_lines(run({"three.gltf", "--json"}).out);
    ASSERT_EQ(of_instances.size(), 3u);
    EXPECT_EQ(of_instances[0]["a"], "bolt[0]");
    EXPECT_EQ(of_instances[0]["depth"], 0);

    write_cube("a.obj", 0);
    write_cube("b.obj", 0.75);
    const auto text_of = [&](const char* name) {
        std::ifstream obj(folder_.path() / name);
        return std::string(std::istreambuf_iterator<char>(obj), {});
    };
    std::string second = text_of("b.obj");
    for (std::size_t at = second.find("f "); at != std::string::npos; at = second.find("f ", at + 1)) {
        std::istringstream corners(second.substr(at + 2, second.find('\n', at) - at - 2));
        std::string face = "f";
        for (int corner = 0; corners >> corner;) face.append(" ").append(std::to_string(corner + 8));
        second.replace(at, second.find('\n', at) - at, face);
    }
    folder_.write("both.obj", "o left\n" + text_of("a.obj") + "o right\n" + second);
    const auto of_objects = json_lines(run({"both.obj", "--json"}).out);
    ASSERT_EQ(of_objects.size(), 1u);
    EXPECT_EQ(of_objects[0]["a"], "left");
    EXPECT_EQ(of_objects[0]["b"], "right");
    EXPECT_NEAR(of_objects[0]["depth"].get<double>(), 0.25, 1e-6);
    const std::string text = run({"both.obj"}).out;
    EXPECT_NEAR(std::stod(text), 0.25, 1e-6) << text;
    EXPECT_NE(text.find(" m  left  x  right  at "), std::string::npos) << text;
}

TEST_F(Clash, AlongAPathAndOverARange) {
    write_assembly("row.gltf", {{"left", 0}, {"middle", 3}, {"right", 9}});
    // Two metres of slide, and the middle is met.
    const ProgramResult slide = run({"row.gltf", "--range", "left=slide:2,0,0:0:4", "--unit", "m"});
    EXPECT_EQ(slide.status, 0) << slide.err;
    EXPECT_NE(slide.out.find("meet"), std::string::npos) << slide.out;
    EXPECT_NE(slide.out.find("left  x  middle"), std::string::npos) << slide.out;
    EXPECT_NE(slide.out.find("left and right come nearest, 4"), std::string::npos) << slide.out;
    const ProgramResult lines = run({"row.gltf", "--range", "left=slide:1,0,0:1:4", "--json"});
    const json line = json::parse(lines.out);
    EXPECT_EQ(line["moving"], "left");
    EXPECT_EQ(line["other"], "middle");
    EXPECT_TRUE(line["meet"].get<bool>());
    EXPECT_NEAR(line["at"].get<double>(), 2, 1e-5);
    // A turn about the far edge of the middle, in degrees; nothing is met below a right angle.
    EXPECT_EQ(run({"row.gltf", "--range", "left=turn:0,0,1:0,0,0:-360:360", "--check"}).status, 0);
    const ProgramResult turn = run({"row.gltf", "--range", "left=turn:0,0,1:3,-3,0:0:-170", "--json", "--check"});
    EXPECT_EQ(turn.status, 3) << turn.err;
    // Poses of the one part, or moves from where it is: the same way.
    const auto matrix = [](double x) { return json{1, 0, 0, x, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; };
    folder_.write("poses.json", json{{"moving", "right"}, {"poses", {matrix(9), matrix(5)}}}.dump());
    folder_.write("moves.json", json{{"moving", {"right"}}, {"moves", {matrix(0), matrix(-4)}}}.dump());
    const ProgramResult poses = run({"row.gltf", "--along", "poses.json", "--clearance", "1.5"});
    EXPECT_EQ(poses.out, run({"row.gltf", "--along", "moves.json", "--clearance", "1.5"}).out);
    EXPECT_NE(poses.out.find("1 m apart"), std::string::npos) << poses.out;
    EXPECT_NE(poses.out.find("pose 1"), std::string::npos) << poses.out;
}

TEST_F(Clash, RefusesPathsThatAreNotSound) {
    write_assembly("row.gltf", {{"left", 0}, {"middle", 3}});
    const auto refused = [&](std::vector<std::string> words, const std::string& why) {
        words.insert(words.begin(), "row.gltf");
        const ProgramResult result = run(words);
        EXPECT_EQ(result.status, 2) << why;
        EXPECT_NE(result.err.find(why), std::string::npos) << result.err;
    };
    refused({"--range", "left=turn:0,0,1:0:90"}, "NAME=turn:AXIS:POINT:FROM:TO");
    refused({"--range", "left=slide:0,0,0:0:90"}, "the way is zero");
    refused({"--range", "left=slide:1,0,0:0:far"}, "\"far\" is no number");
    refused({"--range", "nobody=slide:1,0,0:0:1"}, "nobody");
    refused({"--range", "left=slide:1,0,0:0:1", "--volume"}, "--volume");
    refused({"--along", "none.json"}, "cannot be read");
    folder_.write("poses.json", R"({"moving": "left", "poses": [[1, 2, 3]]})");
    refused({"--along", "poses.json"}, "16 numbers");
    folder_.write("poses.json", R"({"moving": "left"})");
    refused({"--along", "poses.json"}, "\"moves\"");
    folder_.write("poses.json", "{");
    refused({"--along", "poses.json"}, "is no JSON");
    folder_.write("poses.json", R"({"moving": "l*", "poses": [[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]]})");
    refused({"--along", "poses.json"}, "of one part");
}

} // namespace
