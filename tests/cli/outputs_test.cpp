// SPDX-License-Identifier: Apache-2.0
// No result is thrown away: refused commands, signals, kills, a second run of the same name, a disk that is full.
#include "expect.h"

#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <thread>

namespace {

using nlohmann::json;

class Outputs : public testing::Test {
protected:
    ProgramResult run(const std::vector<std::string>& words) const { return run_program(words, folder_.path()); }
    std::filesystem::path at(const std::string& name) const { return folder_.path() / name; }
    bool is_there(const std::string& name) const { return std::filesystem::exists(at(name)); }
    std::string text_of(const std::string& name) const {
        std::ifstream in(at(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    json replayed(const std::string& file) const {
        const auto result = run({"replay", file, "--json"});
        EXPECT_EQ(result.status, 0) << result.err;
        return json::parse(result.out);
    }

    /// A run that does not end by itself, and its first steps.
    static std::vector<std::string> endless(std::vector<std::string> more) {
        more.insert(more.begin(), {"run", "avalanche", "--bodies", "8", "--steps", "1000000", "--json"});
        return more;
    }
    static std::vector<std::string> short_run(std::vector<std::string> more) {
        more.insert(more.begin(), {"run", "avalanche", "--bodies", "8", "--steps", "20", "--json"});
        return more;
    }
    /// Its recording exists from the first step on.
    void wait_for(const std::string& file) const {
        for (;;) { // on a busy machine for long; ctest ends what hangs
            std::error_code none;
            if (std::filesystem::file_size(at(file), none) > 0 && !none) return;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
    }
    /// The name is there before the meshes are written whole; a kill in between leaves no step to read.
    void wait_for_a_step(const std::string& file) const {
        wait_for(file);
        for (;;) {
            const auto result = run({"replay", file, "--json"});
            if (result.status == 0 && json::parse(result.out)["steps"] > 0) return;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
    }
    /// Of a run that was ended: what it printed.
    static json cut_short(const ProgramResult& result, int status) {
        EXPECT_EQ(result.status, status) << result.err;
        json log = json::parse(result.out);
        EXPECT_EQ(log["cut_short"], true);
        EXPECT_EQ(log["steps_planned"], 1000000);
        EXPECT_GT(log["steps"].get<int>(), 0);
        EXPECT_LT(log["steps"].get<int>(), 1000000);
        return log;
    }
    TemporaryFolder folder_;
};

TEST_F(Outputs, ARefusedCommandChangesNothing) {
    std::filesystem::create_directory(at("out"));
    folder_.write("out/steps.csv", "old");
    folder_.write("pile.glb", "old");
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"run", "landslide"},
          {"run", "--mesh", "missing.obj"},
          {"run", "avalanche", "--devices", "cuda:77"},
          {"run", "avalanche", "--displacement-threshold", "0.02", "--distance-extension", "0.01"}}) {
        auto all = words;
        all.insert(all.end(), {"--out", "out", "--record", "pile.glb"});
        EXPECT_EQ(run(all).status, 2);
        EXPECT_EQ(text_of("out/steps.csv"), "old") << words.back();
        EXPECT_EQ(text_of("pile.glb"), "old") << words.back();
        EXPECT_FALSE(is_there("pile.glb.part"));
        EXPECT_FALSE(is_there("out/steps.csv.part"));
    }
}

TEST_F(Outputs, AreCheckedBeforeTheFirstStep) {
    const std::string most(246, 'x');
    std::filesystem::create_directories(at("out/report.html"));
    std::filesystem::create_directory(at("folder.glb"));
    folder_.write("file", "no folder can be made here");
    for (const std::vector<std::string>& words : {std::vector<std::string>{"--record", most + ".glb"},
                                                  {"--record", "file/a.glb"},
                                                  {"--record", "folder.glb"},
                                                  {"--out", std::string(300, 'x')},
                                                  {"--out", "out"},
                                                  {"--out", ""}})
        expect_refused(run(endless(words)), words[1].empty() ? "--out" : words[1]);
    EXPECT_EQ(run(short_run({"--record", std::string(241, 'x') + ".glb"})).status, 0);
}

TEST_F(Outputs, ASignalWritesTheStepsDone) {
    StartedProgram program(endless({"--record", "pile.glb", "--out", "out"}), folder_.path());
    wait_for("pile.glb.part");
    program.send(SIGINT);
    const json log = cut_short(program.wait(), 130);
    const auto rows = csv_rows(at("out/steps.csv"));
    EXPECT_EQ(rows.size(), log["steps"]);
    EXPECT_EQ(sum_of(rows, "contacts"), log["contacts"].get<double>());
    EXPECT_NE(text_of("out/report.html").find("Cut short: "), std::string::npos);
    const json again = replayed("pile.glb");
    EXPECT_EQ(again["steps"], log["steps"]);
    EXPECT_EQ(again["hash"], log["hash"]);
    EXPECT_EQ(again["complete"], true);
    EXPECT_FALSE(is_there("pile.glb.part"));
    EXPECT_FALSE(is_there("out/steps.csv.part"));
}

TEST_F(Outputs, CutResultsLieBesideThoseThatWereThere) {
    std::filesystem::create_directory(at("out"));
    folder_.write("out/steps.csv", "old"); // of the folder's names one is taken, so all are cut
    folder_.write("pile.glb", "old");
    StartedProgram program(endless({"--record", "pile.glb", "--out", "out"}), folder_.path());
    wait_for("pile.glb.part");
    program.send(SIGTERM);
    const json log = cut_short(program.wait(), 143);
    EXPECT_EQ(text_of("pile.glb"), "old");
    EXPECT_EQ(text_of("out/steps.csv"), "old");
    EXPECT_FALSE(is_there("out/report.html"));
    EXPECT_EQ(replayed("pile.glb.cut")["hash"], log["hash"]);
    EXPECT_NE(text_of("out/report.html.cut").find("Cut short: "), std::string::npos);
    EXPECT_EQ(csv_rows(at("out/steps.csv.cut")).size(), log["steps"]);
}

TEST_F(Outputs, AReplayIsCutShortAlike) {
    ASSERT_EQ(run({"run", "avalanche", "--bodies", "27", "--steps", "900", "--record", "pile.glb"}).status, 0);
    StartedProgram program({"replay", "pile.glb", "--caster", "basic", "--method", "standard", "--compare", "standard",
                            "--json", "--out", "out"},
                           folder_.path());
    program.send(SIGHUP);
    const auto result = program.wait();
    ASSERT_EQ(result.status, 129) << result.err;
    const json log = json::parse(result.out);
    EXPECT_EQ(log["cut_short"], true);
    EXPECT_LT(log["steps"], log["steps_planned"]);
    EXPECT_TRUE(log["hash_reproduced"].is_null());
    EXPECT_EQ(csv_rows(at("out/steps.csv")).size(), log["steps"]);
    EXPECT_TRUE(is_there("out/narrow_ms.svg"));
}

TEST_F(Outputs, ANameIsOfOneRunAtATime) {
    const StartedProgram killed(endless({"--record", "other.glb", "--out", "out"}), folder_.path());
    StartedProgram program(endless({"--record", "pile.glb"}), folder_.path());
    wait_for("other.glb.part");
    wait_for("pile.glb.part");
    expect_refused(run(short_run({"--record", "pile.glb"})), "pile.glb: cannot be written: another run is writing it");
    expect_refused(run(short_run({"--out", "out"})), "another run is writing it");
    program.send(SIGINT);
    const json log = cut_short(program.wait(), 130);
    EXPECT_EQ(replayed("pile.glb")["hash"], log["hash"]);
}

TEST_F(Outputs, AKilledRunLeavesItsStepsAndTheNextNamesThem) {
    folder_.write("pile.glb", "old");
    for (int i = 0; i < 2; ++i) {
        StartedProgram program(endless({"--record", "pile.glb"}), folder_.path());
        if (i > 0) wait_for("pile.glb.1.part");
        wait_for_a_step("pile.glb.part");
        program.send(SIGKILL);
        EXPECT_EQ(program.wait().status, 137);
        EXPECT_EQ(text_of("pile.glb"), "old");
        EXPECT_EQ(replayed("pile.glb.part")["complete"], false);
    }
    const auto result = run(short_run({"--record", "pile.glb"}));
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(replayed("pile.glb")["steps"], 20);
    for (const char* left : {"pile.glb.1.part", "pile.glb.2.part"}) {
        EXPECT_NE(result.err.find(left), std::string::npos) << result.err;
        EXPECT_EQ(replayed(left)["complete"], false);
    }
}

TEST_F(Outputs, AFullDiskStillPrintsTheSummary) {
    std::filesystem::create_directory(at("out"));
    folder_.write("out/steps.csv", "old");
    const auto result = run_limited(
        "-f 8", {"run", "avalanche", "--bodies", "8", "--steps", "60", "--json", "--out", "out"}, folder_.path());
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(json::parse(result.out)["steps"], 60);
    EXPECT_NE(result.err.find("cannot be written"), std::string::npos) << result.err;
    EXPECT_EQ(text_of("out/steps.csv"), "old");
    EXPECT_FALSE(is_there("out/report.html"));
}

TEST_F(Outputs, ARecordingThatCannotGrowDoesNotEndTheRun) {
    const auto result = run_limited(
        "-f 256", {"run", "avalanche", "--bodies", "27", "--steps", "600", "--json", "--record", "pile.glb"},
        folder_.path());
    EXPECT_EQ(result.status, 1) << result.err;
    EXPECT_EQ(json::parse(result.out)["steps"], 600);
    EXPECT_NE(result.err.find("pile.glb.part"), std::string::npos) << result.err;
    EXPECT_FALSE(is_there("pile.glb"));
    EXPECT_GT(replayed("pile.glb.part")["steps"], 0);
}

} // namespace
