// SPDX-License-Identifier: Apache-2.0
// raycontact-bench from outside: keys, files, exit status.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct Ran {
    int status = -1;
    std::string out; ///< stdout and, where asked for, stderr
};

Ran run(const std::string& arguments, bool with_stderr = false) {
    const std::string command = "\"" RAYCONTACT_BENCH_FILE "\" " + arguments + (with_stderr ? " 2>&1" : " 2>/dev/null");
    Ran ran;
    FILE* pipe = popen(command.c_str(), "r");
    if (!pipe) return ran;
    std::array<char, 4096> part;
    for (std::size_t n; (n = fread(part.data(), 1, part.size(), pipe)) > 0;) ran.out.append(part.data(), n);
    const int ended = pclose(pipe);
    ran.status = WIFEXITED(ended) ? WEXITSTATUS(ended) : -1;
    return ran;
}

/// A folder that goes with the test.
struct Folder {
    Folder() : path(fs::temp_directory_path() / ("raycontact-bench-" + std::to_string(getpid()))) {
        fs::remove_all(path);
    }
    ~Folder() { fs::remove_all(path); }
    fs::path path;
};

fs::path file_with(const fs::path& folder, const std::string& start, const std::string& ending) {
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.path().filename().string().starts_with(start) && entry.path().extension() == ending)
            return entry.path();
    return {};
}

std::string content(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
}

using Row = std::map<std::string, std::string>; ///< by the names of the columns

/// Of a CSV whose quoted fields hold no line ends.
std::vector<Row> table_of(const std::string& csv) {
    std::vector<std::vector<std::string>> lines;
    std::istringstream in(csv);
    for (std::string line; std::getline(in, line);) {
        std::vector<std::string>& fields = lines.emplace_back(1);
        bool quoted = false;
        for (const char c : line) {
            if (c == '"')
                quoted = !quoted;
            else if (c == ',' && !quoted)
                fields.emplace_back();
            else
                fields.back() += c;
        }
    }
    std::vector<Row> rows;
    for (std::size_t i = 1; i < lines.size(); ++i) {
        EXPECT_EQ(lines[i].size(), lines[0].size()) << csv;
        Row& row = rows.emplace_back();
        for (std::size_t k = 0; k < lines[0].size() && k < lines[i].size(); ++k) row[lines[0][k]] = lines[i][k];
    }
    return rows;
}

/// Kinds of wrong rays add up, and so do contacts with those missed and invented.
void expect_whole(const Row& row) {
    const auto number = [&](const char* column) { return std::stoll(row.at(column)); };
    EXPECT_EQ(number("missed") + number("invented") + number("other_triangle"), number("wrong"));
    EXPECT_EQ(number("contacts") + number("missed"), number("contacts_compared") + number("invented"));
    EXPECT_LE(number("contacts_compared"), number("rays_compared"));
    EXPECT_GT(number("contacts_compared"), 0);
    EXPECT_LE(number("walks_lost"), number("walks"));
}

} // namespace

TEST(BenchPeers, PairsWithEveryPeerThatIsThere) {
    const Folder folder;
    const Ran ran =
        run("peers --works pairs-453 --pairs 2 --steps 10 --runs 1 --json --out \"" + folder.path.string() + "\"");
    ASSERT_EQ(ran.status, 0);
    const Json out = Json::parse(ran.out);
    std::set<std::string> peers;
    for (const Json& r : out["results"]) {
        peers.insert(r["peer"]);
        EXPECT_EQ(r["work"], "pairs-453");
        EXPECT_GT(r["us_per_pair_step"], 0);
        EXPECT_GT(r["times_ours"], 0);
        EXPECT_TRUE(r["agrees"]);
    }
    for (const char* peer : {"bvh", "basic", "iterative", "iterative-basic", "predictive", "certified", "gimpact",
                             "embree", "rays", "embree-rays"})
        EXPECT_TRUE(peers.contains(peer)) << peer;
    EXPECT_TRUE(out["machine"].contains("commit"));

    const std::string csv = content(file_with(folder.path, "peers-", ".csv"));
    EXPECT_TRUE(csv.starts_with("date,commit,cpu,")) << csv.substr(0, 80);
    for (const auto& row : table_of(csv)) {
        if (row.at("rays_compared").empty()) continue; // not ours
        expect_whole(row);
        const bool exact = row.at("peer") == "certified" || row.at("peer") == "bvh";
        EXPECT_TRUE(!exact || row.at("wrong") == "0") << row.at("peer");
    }
    EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), 1 + out["results"].size());
    const std::string svg = content(file_with(folder.path, "peers-", ".svg"));
    EXPECT_TRUE(svg.starts_with("<svg"));
    EXPECT_NE(svg.find("gimpact"), std::string::npos);
}

TEST(BenchPeers, AvalancheAndItsRecordingAreTheSameWork) {
    const Folder folder;
    fs::create_directories(folder.path);
    const std::string file = (folder.path / "small.glb").string();
    const std::string record = "\"" RAYCONTACT_PROGRAM_FILE
                               "\" run avalanche --bodies 8 --steps 60 --speculative off --json --record \""
                               + file + "\" >/dev/null 2>&1";
    ASSERT_EQ(std::system(record.c_str()), 0);
    const std::string how =
        "peers --works avalanche --only bvh,certified,embree --bodies 8 --avalanche-first 40 --avalanche-steps 20 "
        "--avalanche-stride 5 --runs 1 --json";
    const Ran here = run(how), recorded = run(how + " --recording \"" + file + "\"");
    ASSERT_EQ(here.status, 0);
    ASSERT_EQ(recorded.status, 0);
    const Json one = Json::parse(here.out)["results"][0], two = Json::parse(recorded.out)["results"][0];
    EXPECT_EQ(one["steps"], 20); // ours keep something from step to step, so they are given all
    EXPECT_GT(one["contacts"], 0);
    EXPECT_EQ(one["hash"], two["hash"]); // the poses are the same bits, whoever found the pairs
    const Json results = Json::parse(here.out)["results"];
    ASSERT_EQ(results.size(), 3u);
    EXPECT_EQ(results[1]["peer"], "certified");
    EXPECT_EQ(results[1]["hash"], one["hash"]);
    EXPECT_EQ(results[1]["wrong_rays"]["total"], 0);
    EXPECT_EQ(results[2]["steps"], 4); // one in the middle of every stride
    EXPECT_GT(results[2]["times_certified"], 0);
}

TEST(BenchPeers, BadUsage) {
    for (const char* arguments :
         {"", "peers --only nobody", "peers --works nothing", "peers --mesh /no/such.obj",
          "peers --works avalanche --recording /no/such.glb", "peers --runs 0", "growth --pairs 0", "growth --steps 0",
          "growth --threads=-1", "growth --only nothing", "growth --out ''", "device --out ''", "peer"}) {
        const Ran ran = run(arguments, true);
        EXPECT_EQ(ran.status, 2) << arguments << ": " << ran.out;
        EXPECT_EQ(std::count(ran.out.begin(), ran.out.end(), '\n'), 1) << arguments << ": " << ran.out;
    }
}

TEST(Bench, HelpNamesEveryBenchmark) {
    const Ran whole = run("--help", true);
    EXPECT_EQ(whole.status, 0);
    for (const std::string name :
         {"peers", "growth", "device", "rays", "stacks", "holds", "motion", "clash", "new-shape", "factory"}) {
        EXPECT_NE(whole.out.find("\n  " + name + " "), std::string::npos) << name;
        EXPECT_EQ(run(name + " --help", true).status, 0) << name;
        EXPECT_EQ(run(name + " --no-such-option", true).status, 2) << name;
    }
}

TEST(Bench, WorldsAreWritten) {
    const Folder folder;
    const std::string out = " --out \"" + folder.path.string() + "\"";
    ASSERT_EQ(run("stacks --seconds 0.1 --only table --ground plane --finder edges" + out).status, 0);
    EXPECT_FALSE(table_of(content(file_with(folder.path, "stacks-", ".csv"))).empty());
    ASSERT_EQ(
        run("holds --seconds 0.1 --only 'column of cubes' --finder ours --speculative off --print 1 2" + out).status,
        0);
    EXPECT_EQ(table_of(content(file_with(folder.path, "holds-", ".csv"))).size(), 1u);
    const std::string page = content(file_with(folder.path, "holds-", ".html"));
    EXPECT_NE(page.find("--speculative off --print 1 2 --out"), std::string::npos);
    ASSERT_EQ(run("motion --seconds 0.6 --only 'box slides on closed 1 x 1' --finder convex" + out).status, 0);
    EXPECT_FALSE(table_of(content(file_with(folder.path, "motion-", ".csv"))).empty());
}

TEST(BenchGrowth, EveryPart) {
    const Folder folder;
    const Ran ran =
        run("growth --bodies 64 --steps 30 --triangles 316 --pairs 2 --json --out \"" + folder.path.string() + "\"");
    ASSERT_EQ(ran.status, 0);
    const Json rows = Json::parse(ran.out)["rows"];
    std::map<std::string, std::size_t> parts;
    for (const Json& row : rows) {
        ++parts[row["part"]];
        EXPECT_GT(row["narrow_ms"], 0);
    }
    // Three methods; of meshes so small none is in the part that keeps the contacts.
    EXPECT_EQ(parts, (std::map<std::string, std::size_t>{{"triangles", 6}, {"displacement", 24}, {"bodies", 3}}));
    EXPECT_EQ(rows.back()["size"], 64);
    EXPECT_EQ(rows.back()["method"], "certified");
    EXPECT_EQ(table_of(content(file_with(folder.path, "growth-", ".csv"))).size(), rows.size());
    EXPECT_NE(content(file_with(folder.path, "growth-", ".csv")).find("triangles,316"), std::string::npos);
    EXPECT_TRUE(content(file_with(folder.path, "growth-", ".svg")).starts_with("<svg"));
    EXPECT_FALSE(Json::parse(ran.out)["slopes"].empty());
}

TEST(BenchDevice, StepsAndKernelsOfTheCpu) {
    const Folder folder;
    const std::string how = "device --bodies 8 --steps 90:96 --basic-steps 3 --copies 2 --runs 2 --devices cpu ";
    const Ran ran = run(how + "--json --out \"" + folder.path.string() + "\"");
    ASSERT_EQ(ran.status, 0);
    const Json out = Json::parse(ran.out);
    ASSERT_EQ(out["devices"].size(), 1u);
    EXPECT_GT(out["devices"][0]["copy_gb_per_s"], 0);
    EXPECT_GT(out["devices"][0]["launch_and_wait_us"], 0);
    ASSERT_EQ(out["results"].size(), 8u); // four methods, two casters
    std::size_t rows = 5;                 // of the device
    for (const Json& r : out["results"]) {
        EXPECT_TRUE(r["agrees"]);
        EXPECT_EQ(r["steps"], r["caster"] == "bvh" ? 6 : 3);
        EXPECT_GT(r["contacts"], 0);
        EXPECT_GE(r["step_us"], r["narrow_us"]);
        double launches = 0, share = 0;
        for (const Json& k : r["kernels"]) {
            launches += k["launches"].get<double>();
            share += k["share"].get<double>();
        }
        EXPECT_NEAR(launches, r["launches"].get<double>(), 2) << "a median against a mean";
        EXPECT_NEAR(share, 1, 1e-6);
        rows += 1 + r["kernels"].size();
    }
    // What standard finds, certified does; and every copy finds what one does.
    const Json& results = out["results"];
    EXPECT_EQ(results[0]["hash"], results[1]["hash"]);
    const Json once = Json::parse(run("device --bodies 8 --steps 90:96 --casters bvh --methods standard --runs 1 "
                                      "--devices cpu --json")
                                      .out)["results"];
    ASSERT_EQ(once.size(), 1u);
    EXPECT_EQ(results[0]["contacts"], 2 * once[0]["contacts"].get<double>());
    EXPECT_NE(results[0]["hash"], once[0]["hash"]);

    const std::string csv = content(file_with(folder.path, "device-", ".csv"));
    EXPECT_TRUE(csv.starts_with("date,commit,cpu,")) << csv.substr(0, 80);
    const std::vector<Row> table = table_of(csv);
    ASSERT_EQ(table.size(), rows);
    for (const Row& row : table) {
        EXPECT_EQ(row.at("device"), "cpu");
        EXPECT_EQ(row.at("agrees"), row.at("what") == "step" ? "1" : "");
    }
}

TEST(BenchDevice, RefusesWhatItCannotDo) {
    for (const std::string arguments : {"--steps 5", "--steps 5:6", "--steps 5:x", "--steps :9", "--devices gpu",
                                        "--methods none", "--casters none", "--recording missing.glb"}) {
        const Ran ran = run("device --bodies 1 " + arguments, true);
        EXPECT_EQ(ran.status, 2) << arguments;
        EXPECT_EQ(std::count(ran.out.begin(), ran.out.end(), '\n'), 1) << ran.out;
    }
}
