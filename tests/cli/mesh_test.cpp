// SPDX-License-Identifier: Apache-2.0
// raycontact mesh: several files, a verdict for each, --strict, --cavities, --weld; the other commands' --cavities and
// --weld.
#include "expect.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace {

/// A cube with its lower corner there, of edge 1 unless told; its faces are numbered after `before` vertices.
std::string cube_at(double at, double edge, int before) {
    std::string text;
    for (int i = 0; i < 8; ++i) {
        text += "v";
        for (const int bit : {1, 2, 4}) text.append(" ").append(std::to_string(at + ((i & bit) != 0 ? edge : 0.0)));
        text += "\n";
    }
    constexpr int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& face : faces) {
        text += "f";
        for (const int corner : face) text.append(" ").append(std::to_string(before + corner + 1));
        text += "\n";
    }
    return text;
}

/// A cube as three corners for each triangle, which differ by some 1e-7: from `side` along x and y, from `low` along z.
std::string loose_cube(double side, double low, double edge) {
    constexpr int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    std::string text;
    char line[100];
    int corner = 0;
    for (const auto& face : faces)
        for (const int k : {0, 1, 2, 0, 2, 3}) {
            text += "v";
            for (const int bit : {1, 2, 4}) {
                const double off = 1e-8 * ((++corner * 37) % 11 - 5);
                std::snprintf(line, sizeof line, " %.9f",
                              (bit == 4 ? low : side) + ((face[k] & bit) != 0 ? edge : 0) + off);
                text += line;
            }
            text += "\n";
        }
    for (int v = 1; v <= 36; v += 3) {
        std::snprintf(line, sizeof line, "f %d %d %d\n", v, v + 1, v + 2);
        text += line;
    }
    return text;
}

class MeshCommand : public testing::Test {
protected:
    MeshCommand() {
        folder_.write("cube.obj", cube_obj());
        std::string open = cube_obj();
        folder_.write("open.obj", open.substr(0, open.rfind("f ")));
        folder_.write("crossed.obj", cube_at(0, 1, 0) + cube_at(0.5, 1, 8));
        folder_.write("nested.obj", cube_at(0, 4, 0) + cube_at(1, 1, 8));
    }
    ProgramResult run(const std::vector<std::string>& arguments) const {
        return run_program(arguments, folder_.path());
    }
    /// Lines of text, without the last, empty one.
    static std::vector<std::string> lines(const std::string& text) {
        std::vector<std::string> all;
        for (std::size_t from = 0; from < text.size(); from = text.find('\n', from) + 1)
            all.push_back(text.substr(from, text.find('\n', from) - from));
        return all;
    }
    TemporaryFolder folder_;
};

TEST_F(MeshCommand, EndsWithAVerdictForEachFile) {
    const auto one = run({"mesh", "cube.obj"});
    EXPECT_EQ(one.status, 0);
    EXPECT_EQ(lines(one.out).back(), "cube.obj: good for contacts");

    const auto all = run({"mesh", "cube.obj", "open.obj", "crossed.obj", "nested.obj"});
    EXPECT_EQ(all.status, 0) << all.err;
    EXPECT_EQ(all.err, "");
    const auto text = lines(all.out);
    ASSERT_GT(text.size(), 8u);
    const auto verdict = [&](std::size_t from_last) { return text[text.size() - from_last]; };
    EXPECT_EQ(verdict(4), "cube.obj: good for contacts");
    EXPECT_TRUE(verdict(3).starts_with("open.obj: open: 4 border edges")) << verdict(3);
    EXPECT_EQ(verdict(2), "crossed.obj: good for contacts"); // united
    EXPECT_EQ(verdict(1), "nested.obj: good for contacts");
    const auto as_is = lines(run({"mesh", "crossed.obj", "nested.obj", "--as-is"}).out);
    EXPECT_TRUE(as_is[as_is.size() - 2].starts_with("crossed.obj: self-intersecting: "));
    EXPECT_TRUE(as_is.back().starts_with("nested.obj: nested: "));
}

TEST_F(MeshCommand, JsonIsOneObjectAFile) {
    const auto result = run({"mesh", "cube.obj", "open.obj", "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    const auto objects = json_lines(result.out);
    ASSERT_EQ(objects.size(), 2u);
    EXPECT_EQ(objects[0]["file"], "cube.obj");
    EXPECT_EQ(objects[0]["verdict"], "good for contacts");
    EXPECT_EQ(objects[0]["good"], true);
    EXPECT_EQ(objects[0]["border_edges"], 0);
    EXPECT_EQ(objects[1]["file"], "open.obj");
    EXPECT_EQ(objects[1]["good"], false);
    EXPECT_EQ(objects[1]["border_edges"], 4);
}

TEST_F(MeshCommand, ClosesAndWritesWhatItClosed) {
    const auto closed = run({"mesh", "open.obj", "--close", "--write", "closed.obj"});
    EXPECT_EQ(closed.status, 0) << closed.err;
    EXPECT_EQ(lines(closed.out).back(), "open.obj: good for contacts: a solid, of which 1 hole is spanned");
    const auto again = json_lines(run({"mesh", "closed.obj", "--as-is", "--json"}).out).at(0);
    EXPECT_EQ(again["kind"], "solid");
    EXPECT_EQ(again["triangles"], 12);
    EXPECT_EQ(json_lines(run({"mesh", "open.obj", "--json"}).out).at(0)["kind"], "sheet");
    expect_refused(run({"mesh", "open.obj", "--write", "open.obj"}), "is one of the files to read");
    expect_refused(run({"mesh", "open.obj", "--write", "closed.stl"}), "give a name that ends in .obj");
    expect_refused(run({"mesh", "open.obj", "cube.obj", "--write", "closed.obj"}), "give one mesh file");
    expect_refused(run({"mesh", "open.obj", "--close", "--as-is"}), "--close");
}

TEST_F(MeshCommand, StrictIsStatusTwoWhereOneIsBad) {
    EXPECT_EQ(run({"mesh", "cube.obj", "cube.obj", "--strict"}).status, 0);
    const auto one = run({"mesh", "open.obj", "--strict"});
    EXPECT_EQ(one.status, 2);
    EXPECT_TRUE(lines(one.out).back().starts_with("open.obj: open")); // what was found is printed all the same
    EXPECT_EQ(one.err, "raycontact: --strict: not good for contacts: open.obj\n");
    const auto two = run({"mesh", "open.obj", "cube.obj", "crossed.obj", "open.obj", "--strict", "--json"});
    EXPECT_EQ(two.status, 2);
    EXPECT_EQ(json_lines(two.out).size(), 4u);
    EXPECT_EQ(two.err, "raycontact: --strict: not good for contacts: open.obj and 1 more\n");
}

TEST_F(MeshCommand, AFileThatCannotBeReadDoesNotStopTheOthers) {
    folder_.write("bad.obj", "v 0 0 x\n");
    const auto result = run({"mesh", "bad.obj", "cube.obj", "missing.obj"});
    EXPECT_EQ(result.status, 2);
    const auto text = lines(result.out);
    ASSERT_GT(text.size(), 3u);
    EXPECT_EQ(text[text.size() - 3], "bad.obj: refused: line 1: coordinate 'x' is not a number");
    EXPECT_EQ(text[text.size() - 2], "cube.obj: good for contacts");
    EXPECT_TRUE(text.back().starts_with("missing.obj: refused: no such file")) << text.back();
    EXPECT_EQ(lines(result.err).size(), 2u) << result.err;
    EXPECT_TRUE(result.err.starts_with("raycontact: bad.obj: line 1")) << result.err;
    const auto json = run({"mesh", "bad.obj", "cube.obj", "--json"});
    EXPECT_EQ(json.status, 2);
    const auto objects = json_lines(json.out);
    ASSERT_EQ(objects.size(), 2u);
    EXPECT_EQ(objects[0]["file"], "bad.obj");
    EXPECT_EQ(objects[0]["good"], false);
    EXPECT_FALSE(objects[0].contains("closed"));
    EXPECT_EQ(objects[1]["good"], true);
    expect_refused(run({"mesh", "bad.obj"}), "bad.obj");
}

TEST_F(MeshCommand, PartsInPartsAreMadeCavitiesOrSolidsWhenAskedFor) {
    const auto report = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words{"mesh", "nested.obj", "--json"};
        words.insert(words.end(), more.begin(), more.end());
        const auto result = run(words);
        EXPECT_EQ(result.status, 0) << result.err;
        return json_lines(result.out).at(0);
    };
    EXPECT_DOUBLE_EQ(report({})["volume"], 64);
    EXPECT_DOUBLE_EQ(report({"--cavities", "make"})["volume"], 63);
    EXPECT_EQ(report({"--cavities", "make"})["good"], true);
    EXPECT_DOUBLE_EQ(report({"--cavities", "undo"})["volume"], 64);
    expect_refused(run({"mesh", "nested.obj", "--cavities", "caves"}), "--cavities: 'caves' is unknown");
    expect_refused(run({"mesh", "nested.obj", "--cavities", "make", "--as-is"}), "--cavities");
}

TEST_F(MeshCommand, CollideAndRunTakeTheSameWord) {
    folder_.write("small.obj", cube_at(1.25, 0.5, 0)); // in the inner part of nested.obj
    const auto contacts = [&](const char* word) {
        const auto result = run({"collide", "small.obj", "nested.obj", "--json", "--cavities", word});
        EXPECT_EQ(result.status, 0) << result.err;
        return json_lines(result.out).at(0)["contacts"].size();
    };
    EXPECT_EQ(contacts("make"), 0u);
    EXPECT_GT(contacts("undo"), 0u);
    expect_refused(run({"collide", "cube.obj", "cube.obj", "--cavities", "no"}), "--cavities");
    expect_refused(run({"run", "avalanche", "--cavities", "undo"}), "--cavities");
    EXPECT_EQ(run({"run", "--mesh", "nested.obj", "--cavities", "make", "--steps", "2", "--bodies", "2"}).status, 0);
}

TEST_F(MeshCommand, ProposesALengthThatClosesAndTheCommandsTakeIt) {
    folder_.write("a.obj", loose_cube(0, 0, 1));
    folder_.write("b.obj", loose_cube(0.25, 0.9, 0.5));
    const auto open = json_lines(run({"mesh", "a.obj", "open.obj", "cube.obj", "--json"}).out);
    EXPECT_EQ(open.at(0)["weld"], 1e-6);
    EXPECT_EQ(open.at(0)["good"], false);
    const std::string verdict = open.at(0)["verdict"];
    EXPECT_TRUE(verdict.ends_with("its corners differ in their last digits: --weld 1e-06 closes it")) << verdict;
    EXPECT_TRUE(open.at(1)["weld"].is_null());
    EXPECT_TRUE(open.at(2)["weld"].is_null());
    const auto welded = json_lines(run({"mesh", "a.obj", "--weld", "1e-6", "--json"}).out).at(0);
    EXPECT_EQ(welded["good"], true);
    EXPECT_EQ(welded["vertices"], 8);
    const std::string repair = welded["repairs"].at(0);
    EXPECT_TRUE(repair.starts_with("welded ")) << repair;

    const auto depth = [&](std::vector<std::string> words) {
        double deepest = 0;
        for (const auto& line : json_lines(run(words).out)) {
            if (line.contains("depth") && !line["depth"].is_null()) deepest = line["depth"];
            if (!line.contains("pair")) continue;
            for (const auto& contact : line["contacts"]) deepest = std::max(deepest, contact["depth"].get<double>());
        }
        return deepest;
    };
    EXPECT_NEAR(depth({"collide", "a.obj", "b.obj", "--json", "--weld", "1e-6"}), 0.1, 1e-6);
    EXPECT_NEAR(depth({"clash", "a.obj", "b.obj", "--json", "--weld", "1e-6"}), 0.1, 1e-6);
    EXPECT_EQ(run({"run", "--mesh", "a.obj", "--weld", "1e-6", "--steps", "2", "--bodies", "2"}).status, 0);
    expect_refused(run({"run", "avalanche", "--weld", "1e-6"}), "--weld");
    expect_refused(run({"mesh", "a.obj", "--weld", "0"}), "--weld");
    expect_refused(run({"mesh", "a.obj", "--weld", "1e-6", "--as-is"}), "--weld");
}

TEST_F(MeshCommand, SaysWhatReadingLeftOut) {
    folder_.write("mixed.obj", cube_obj() + "l 1 2\np 3 4\nf 1 2\nv 1 1 -1.#IND\n");
    const auto result = run({"mesh", "mixed.obj", "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(nlohmann::json::parse(result.out)["repairs"],
              nlohmann::json({"left out 1 vertex that is not finite and that no triangle uses",
                              "left out 1 face of two corners", "left out 2 points (p)", "left out 1 line (l)"}));
    EXPECT_NE(run({"mesh", "mixed.obj"}).out.find("\nrepair             left out 2 points (p)\n"), std::string::npos);
}

} // namespace
