// SPDX-License-Identifier: Apache-2.0
// The whole program with a few bodies: every number and figure, nothing twice, and on after it was killed.
#include "program.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <csignal>
#include <fstream>
#include <set>
#include <sstream>
#include <system_error>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

std::map<fs::path, fs::file_time_type> times_of(const fs::path& folder) {
    std::map<fs::path, fs::file_time_type> times;
    for (const auto& entry : fs::directory_iterator(folder)) {
        std::error_code renamed; // by the program, while it writes
        const fs::file_time_type time = entry.last_write_time(renamed);
        if (!renamed) times[entry.path()] = time;
    }
    return times;
}

/// Those that no clock decides.
Json numbers_without_times(const fs::path& file) {
    Json list = Json::array();
    for (const Json& number : Json::parse(text_of(file))) {
        const auto id = number["id"].get<std::string>();
        if (!id.starts_with("speedup.") && !id.starts_with("devices.") && id != "lga13") list.push_back(number);
    }
    return list;
}

std::set<std::string> all_ids() {
    std::set<std::string> ids{"speedup.basic", "speedup.stackless", "lga13", "triangles.rain"};
    for (const std::string object : {"table1.sphere.", "table1.bunny.", "table1.irregular."})
        for (const std::string direction : {"ray", "weighted", "reprojected"}) ids.insert(object + direction);
    for (const std::string scene : {"avalanche", "rain"})
        for (const std::string what : {"table2.", "wrong_rays.", "lengths.", "devices.two.", "pairs."})
            ids.insert(what + scene);
    for (const std::string scene : {"avalanche", "rain"}) ids.insert("table2." + scene + ".speculative");
    return ids;
}

class Reproduce : public testing::Test {
protected:
    ProgramResult run(const std::vector<std::string>& more) const {
        std::vector<std::string> arguments{"reproduce", "--tiny"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_program(arguments, folder_.path());
    }
    TemporaryFolder folder_;
};

TEST_F(Reproduce, AllAfterOneRepeatsNothingAndShowsEverything) {
    const auto one = run({"fig9", "--out", "out"});
    ASSERT_EQ(one.status, 0) << one.err;
    // In a log there is no bar, but lines.
    EXPECT_TRUE(one.err.starts_with("fig9: begins\nfig9: ")) << one.err;
    EXPECT_NE(one.err.find("\nfig9: 100%, 0 s left\n"), std::string::npos) << one.err;
    EXPECT_EQ(one.err.find('\r'), std::string::npos) << one.err;
    const fs::path out = folder_.path() / "out";
    EXPECT_NE(text_of(out / "report.html").find("Not run yet: table1"), std::string::npos);
    const auto before = times_of(out / "cache");
    ASSERT_GE(before.size(), 3u); // the scene, its recording, the wrong rays
    const auto all = run({"--out", "out"});
    ASSERT_EQ(all.status, 0) << all.err;
    EXPECT_NE(all.err.find("fig9: kept from an earlier run"), std::string::npos) << all.err;
    const auto after = times_of(out / "cache");
    for (const auto& [file, time] : before) EXPECT_EQ(after.at(file), time) << file;

    std::set<std::string> ids;
    for (const Json& number : Json::parse(text_of(out / "results.json"))) {
        EXPECT_EQ(keys_of(number), (std::set<std::string>{"id", "paper", "ours", "unit", "verdict", "why"}));
        EXPECT_TRUE(number["ours"].is_number()) << number;
        EXPECT_NE(number["why"], "");
        EXPECT_TRUE(ids.insert(number["id"].get<std::string>()).second) << number;
        const auto id = number["id"].get<std::string>();
        if (id.starts_with("table1") && id.ends_with(".reprojected")) {
            EXPECT_LT(number["ours"].get<double>(), 0.005) << number;
        }
    }
    EXPECT_EQ(ids, all_ids());

    const std::string page = text_of(out / "report.html");
    for (const char* figure : {"Figure 9", "Figure 10", "Figure 11", "Figure 12", "Figure 14", "Figure 15", "Table 1",
                               "Table 2", "Section 5.2", "LGA13"})
        EXPECT_NE(page.find(std::string("<b>") + figure), std::string::npos) << figure; // a plot's title
    for (const std::string& id : ids) EXPECT_NE(page.find("<td>" + id + "</td>"), std::string::npos) << id;
    EXPECT_NE(page.find("Short version (tiny)"), std::string::npos);
    EXPECT_NE(page.find("Measured: "), std::string::npos);
    for (const char* outside : {"http:", "https:", "<script src", "src=\"/", "url("})
        EXPECT_EQ(page.find(outside), std::string::npos) << outside;
}

TEST_F(Reproduce, GoesOnAfterItWasKilled) {
    ASSERT_EQ(run({"table2", "--out", "whole"}).status, 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    const fs::path killed = folder_.path() / "killed";
    if (child == 0) {
        const std::string out = killed.string();
        execl(RAYCONTACT_PROGRAM_FILE, "raycontact", "reproduce", "table2", "--tiny", "--out", out.c_str(),
              static_cast<char*>(nullptr));
        _exit(127);
    }
    const auto parts = [&] { return fs::exists(killed / "cache") ? times_of(killed / "cache").size() : 0; };
    while (parts() < 1) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "it ended before it could be killed";
    EXPECT_FALSE(fs::exists(killed / "results.json"));
    const auto before = times_of(killed / "cache");
    ASSERT_EQ(run({"table2", "--out", "killed"}).status, 0);
    const auto after = times_of(killed / "cache");
    for (const auto& [file, time] : before) {
        if (file.extension() == ".json") {
            EXPECT_EQ(after.at(file), time) << file;
        }
    }
    EXPECT_EQ(numbers_without_times(folder_.path() / "killed" / "results.json"),
              numbers_without_times(folder_.path() / "whole" / "results.json"));
}

TEST_F(Reproduce, OneExperimentPrintsItsTables) {
    const auto volume = run({"volume", "--out", "out"});
    ASSERT_EQ(volume.status, 0) << volume.err;
    EXPECT_NE(volume.out.find("Two runs, by length and by volume"), std::string::npos) << volume.out;
    std::istringstream lines(volume.out);
    std::string line;
    while (std::getline(lines, line) && !line.starts_with("iterative ")) {
    }
    std::istringstream row(line);
    std::string run_name, unit;
    double ray = 0, reprojected = 0, area = 0, litres = 0;
    row >> run_name >> ray >> unit >> reprojected >> unit >> area >> unit >> litres >> unit;
    EXPECT_EQ(unit, "l") << line;
    EXPECT_GT(litres, 0.1) << line;
    EXPECT_LT(litres, area) << line; // rays of vertices lie side by side and are longer than the overlap is thick
    EXPECT_LT(reprojected, ray) << line;
    EXPECT_EQ(run({"--out", "all"}).out.find("Two runs"), std::string::npos);
}

// A threshold beyond what anything moves leaves iterative with what it found when pairs were new.
TEST_F(Reproduce, ConstantsAreThoseOfTheOption) {
    const auto length = [&](const std::string& constants) {
        const auto ran = run({"lengths", "--constants", constants, "--out", constants});
        EXPECT_EQ(ran.status, 0) << ran.err;
        for (const Json& number : Json::parse(text_of(folder_.path() / constants / "results.json")))
            if (number["id"] == "lengths.avalanche") return number["ours"].get<double>();
        return 0.0;
    };
    EXPECT_NE(length("0.2,1,0.21"), length("0.01,1,0.011"));
}

TEST_F(Reproduce, BadInputIsStatusTwo) {
    EXPECT_EQ(run({"lengths", "--constants", "0.04,0.5,0.08", "--out", "out"}).status, 2); // confidence below 1
    EXPECT_EQ(run({"lengths", "--constants", "0.04,1,0.03", "--out", "out"}).status, 2);   // below the threshold
    EXPECT_EQ(run({"lengths", "--constants", "0.04,1", "--out", "out"}).status, 2);

    EXPECT_EQ(run({"fig13", "--out", "out"}).status, 2);
    EXPECT_NE(run({"fig13", "--out", "out"}).err.find("known are all, fig9"), std::string::npos);
    EXPECT_EQ(run({"table1"}).status, 2);
    folder_.write("file", "");
    EXPECT_EQ(run({"table1", "--out", "file"}).status, 2);
}

} // namespace
