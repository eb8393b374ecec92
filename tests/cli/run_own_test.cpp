// SPDX-License-Identifier: Apache-2.0
// `run` with a user's meshes, and the scenes other than the avalanche.
#include "expect.h"

#include <fstream>
#include <iterator>

namespace {

using nlohmann::json;

class RunOwn : public testing::Test {
protected:
    RunOwn() {
        folder_.write("cube.obj", cube_obj());
        folder_.write("ramp.obj", "v -20 -20 0\nv 20 -20 0\nv 20 20 2\nv -20 20 2\nv -20 -20 -3\nv 20 -20 -3\n"
                                  "v 20 20 -3\nv -20 20 -3\nf 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\n"
                                  "f 3 7 8 4\nf 4 8 5 1\n");
        folder_.write("wedge.obj", "v 0 0 0\nv 3 0 0\nv 0 3 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    }
    json run(std::vector<std::string> words) const {
        words.insert(words.begin(), "run");
        words.emplace_back("--json");
        const auto result = run_program(words, folder_.path());
        EXPECT_EQ(result.status, 0) << result.err;
        return json::parse(result.out);
    }
    void refused(std::vector<std::string> words, const std::string& named) const {
        words.insert(words.begin(), "run");
        expect_refused(run_program(words, folder_.path()), named);
    }
    TemporaryFolder folder_;
};

TEST_F(RunOwn, MeshesFallOnASlab) {
    const json log = run({"--mesh", "cube.obj", "wedge.obj", "--bodies", "8", "--size", "0.5", "--steps", "240"});
    EXPECT_EQ(log["scene"], "own");
    EXPECT_EQ(log["bodies"], 8);
    EXPECT_GT(log["contacts"].get<int>(), 0);
    EXPECT_EQ(log["below_ground"], 0);
    EXPECT_EQ(log["flown_off"], 0);
    EXPECT_DOUBLE_EQ(log["depth_limit"].get<double>(), 0.01); // 2 % of the size
    EXPECT_LT(log["median_speed_last_second"].get<double>(), 0.1);
    for (const char* text : {"cube.obj", "8 vertices and 12 triangles", "wedge.obj", "4 x"})
        EXPECT_NE(log["mesh_source"].get<std::string>().find(text), std::string::npos) << text;
    EXPECT_EQ(run({"--mesh", "cube.obj", "wedge.obj", "--bodies", "8", "--size", "0.5", "--steps", "240", "--threads",
                   "3"})["hash"],
              log["hash"]);
}

// A mesh as another program has it, in millimetres: 3000 "metres" long, and more than 100 m above the slab.
TEST_F(RunOwn, SaysWhyAllJustFell) {
    folder_.write("mm.obj", "v 0 0 0\nv 3000 0 0\nv 0 3000 0\nv 0 0 3000\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    const auto said = [&](std::vector<std::string> words, const char* steps = "90") {
        words.insert(words.begin(), {"run", "--bodies", "2", "--steps", steps, "--mesh", "mm.obj"});
        const auto result = run_program(words, folder_.path());
        EXPECT_EQ(result.status, 0);
        return result.err;
    };
    const std::string fell = "for 1.5 s most bodies just fell: a mesh is 3000 m long";
    EXPECT_NE(said({}).find(fell), std::string::npos) << said({});
    EXPECT_NE(said({}).find("give --size"), std::string::npos);
    EXPECT_NE(said({"--ground", "plane"}).find(fell), std::string::npos);
    // They meet the slab, and are too heavy to be stopped.
    EXPECT_NE(said({"--size", "100"}, "240").find(" just fell: a mesh is 100 m long"), std::string::npos);
    EXPECT_EQ(said({"--size", "0.3"}), "");
    EXPECT_EQ(said({"--size", "0.3", "--ground", "plane"}), "") << "on a plane it rests, without contacts";
}

TEST_F(RunOwn, SaysWhatIsWrongWithAMeshThatStandsStill) {
    const std::string corners = "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\n";
    folder_.write("up.obj", corners + "f 1 2 3 4\n");
    folder_.write("down.obj", corners + "f 4 3 2 1\n");
    const auto said = [&](const char* ground) {
        return run_program({"run", "--mesh", "cube.obj", "--bodies", "1", "--steps", "2", "--ground", ground},
                           folder_.path())
            .err;
    };
    const std::string open =
        ": stands still and is open, with 4 border edges: bodies that come from behind its faces pass it";
    EXPECT_NE(said("up.obj").find("up.obj" + open + "\n"), std::string::npos) << said("up.obj");
    EXPECT_NE(said("down.obj").find("down.obj" + open + "; its faces look down, so what falls on it falls through"),
              std::string::npos)
        << said("down.obj");
    EXPECT_EQ(said("ramp.obj").find("stands still"), std::string::npos) << said("ramp.obj");
}

TEST_F(RunOwn, FallOnAMeshOfOnesOwn) {
    const json log = run({"--mesh", "cube.obj", "--bodies", "4", "--steps", "120", "--ground", "ramp.obj"});
    EXPECT_GT(log["contacts"].get<int>(), 0);
    EXPECT_EQ(log["below_ground"], 0);
    EXPECT_EQ(log["flown_off"], 0);
    EXPECT_NE(log["hash"], run({"--mesh", "cube.obj", "--bodies", "4", "--steps", "120"})["hash"]);
}

TEST_F(RunOwn, ThePlaneStopsThemAndIsNotCounted) {
    folder_.write("one cube.obj", cube_obj());
    const json log = run({"--mesh", "one cube.obj", "--bodies", "1", "--steps", "240", "--ground", "plane", "--out",
                          "out", "--record", "fall.glb"});
    EXPECT_EQ(log["contacts"], 0);
    EXPECT_EQ(log["pairs_max"], 0);
    EXPECT_EQ(log["below_ground"], 0);
    EXPECT_EQ(log["flown_off"], 0);
    EXPECT_LT(log["median_speed_last_second"].get<double>(), 0.05); // it has been stopped
    std::ifstream in(folder_.path() / "out/report.html");
    const std::string html{std::istreambuf_iterator<char>(in), {}};
    EXPECT_NE(html.find("run --mesh &#39;one cube.obj&#39; --bodies 1 --ground plane --steps 240 --seed 1"),
              std::string::npos)
        << html.substr(std::min(html.size(), html.find("raycontact run")), 200);
    const auto replay = run_program({"replay", "fall.glb", "--json"}, folder_.path());
    EXPECT_EQ(replay.status, 0) << replay.err;
    EXPECT_EQ(json::parse(replay.out)["hash_reproduced"], true);
}

TEST_F(RunOwn, TheSpeedIsTheMedianOfTheLastSecond) {
    // It falls in the first half of that second and lies in the second.
    const json log = run({"--mesh", "cube.obj", "--bodies", "1", "--steps", "64", "--out", "out", "--no-view"});
    std::vector<double> speeds;
    for (const auto& row : csv_rows(folder_.path() / "out/steps.csv")) speeds.push_back(row.at("median_speed_m_s"));
    ASSERT_EQ(speeds.size(), 64u);
    speeds.erase(speeds.begin(), speeds.begin() + 4);
    std::sort(speeds.begin(), speeds.end());
    EXPECT_NEAR(log["median_speed_last_second"].get<double>(), (speeds[29] + speeds[30]) / 2, 1e-5);
    EXPECT_LT(log["median_speed_last_second"].get<double>(), speeds.back() / 2);
}

TEST_F(RunOwn, WordsAreRightForOne) {
    const auto one = run_program({"run", "--mesh", "cube.obj", "--bodies", "1", "--steps", "1"}, folder_.path());
    EXPECT_TRUE(one.out.starts_with("own: 1 body, 1 step, seed 1; cube.obj (8 vertices and 12 triangles)\n"))
        << one.out;
    const auto two =
        run_program({"run", "--mesh", "cube.obj", "wedge.obj", "--bodies", "3", "--steps", "2"}, folder_.path());
    EXPECT_TRUE(two.out.starts_with("own: 3 bodies, 2 steps, seed 1; 2 x cube.obj (8 vertices and 12 triangles); "
                                    "1 x wedge.obj (4 vertices and 4 triangles)\n"))
        << two.out;
}

TEST_F(RunOwn, TheReportHasAViewUnlessNot) {
    const auto has_view = [&](std::vector<std::string> words, const std::string& out) {
        words.insert(words.begin(), {"--mesh", "cube.obj", "--bodies", "1", "--steps", "3", "--out", out});
        run(words);
        std::ifstream in(folder_.path() / out / "report.html");
        const std::string html{std::istreambuf_iterator<char>(in), {}};
        EXPECT_NE(html.find("Figures of the whole run"), std::string::npos);
        return html.find("<iframe") != std::string::npos;
    };
    EXPECT_TRUE(has_view({}, "with"));
    EXPECT_FALSE(has_view({"--no-view"}, "without"));
    refused({"avalanche", "--no-view"}, "--no-view");
}

TEST_F(RunOwn, DensityChangesNothingButMass) {
    const json light = run({"--mesh", "cube.obj", "--bodies", "1", "--steps", "5", "--density", "1"});
    EXPECT_EQ(run({"--mesh", "cube.obj", "--bodies", "1", "--steps", "5"})["hash"],
              light["hash"]); // nothing is hit yet
    const std::vector<std::string> two{"--mesh", "cube.obj", "--bodies", "2", "--steps", "120"};
    auto lighter = two;
    lighter.insert(lighter.end(), {"--density", "1"});
    EXPECT_NE(run(two)["hash"], run(lighter)["hash"]); // rounding of other masses
}

TEST_F(RunOwn, RainHasAReportAndARecording) {
    const json log = run({"rain", "--steps", "120", "--out", "out", "--record", "rain.glb"});
    EXPECT_EQ(log["scene"], "rain");
    EXPECT_EQ(log["bodies"], 20); // ten a second
    EXPECT_GT(log["contacts"].get<int>(), 0);
    EXPECT_EQ(csv_rows(folder_.path() / "out/steps.csv").size(), 120u);
    EXPECT_GT(std::filesystem::file_size(folder_.path() / "out/report.html"), 10000u);
    const auto replay = run_program({"replay", "rain.glb", "--json"}, folder_.path());
    EXPECT_EQ(replay.status, 0) << replay.err;
    const json again = json::parse(replay.out);
    EXPECT_EQ(again["hash"], log["hash"]);
    EXPECT_EQ(again["bodies"], 20);
    EXPECT_EQ(run({"rain", "--steps", "120", "--bodies", "9"})["bodies"], 9);
}

TEST_F(RunOwn, BadUsage) {
    refused({"--mesh"}, "--mesh");
    refused({"--mesh", "missing.obj"}, "missing.obj");
    refused({"rain", "--mesh", "cube.obj"}, "--mesh");
    for (const char* option : {"--size", "--density"}) {
        for (const char* value : {"0", "-1", "nan", "inf", "much"})
            refused({"--mesh", "cube.obj", option, value}, option);
        refused({"avalanche", option, "1"}, option);
        refused({"scene.json", option, "1"}, option);
    }
    refused({"--mesh", "cube.obj", "--ground", "missing.obj"}, "missing.obj");
    refused({"rain", "--ground", "plane"}, "--ground");
    folder_.write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    refused({"--mesh", "sheet.obj"}, "sheet.obj");
    folder_.write("point.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n");
    refused({"--mesh", "point.obj"}, "point.obj");
}

} // namespace
