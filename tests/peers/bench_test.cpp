// SPDX-License-Identifier: Apache-2.0
// `raycontact bench` from outside: keys, files, exit status.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <string>

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
    const std::string command =
        "\"" RAYCONTACT_PROGRAM_FILE "\" bench " + arguments + (with_stderr ? " 2>&1" : " 2>/dev/null");
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
    for (const char* peer : {"bvh", "basic", "gimpact", "embree", "rays", "embree-rays"})
        EXPECT_TRUE(peers.contains(peer)) << peer;
    EXPECT_TRUE(out["machine"].contains("commit"));

    const std::string csv = content(file_with(folder.path, "peers-", ".csv"));
    EXPECT_TRUE(csv.starts_with("date,commit,cpu,")) << csv.substr(0, 80);
    EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), 1 + out["results"].size());
    const std::string svg = content(file_with(folder.path, "peers-", ".svg"));
    EXPECT_TRUE(svg.starts_with("<svg"));
    EXPECT_NE(svg.find("gimpact"), std::string::npos);
}

TEST(BenchPeers, AvalancheAndItsRecordingAreTheSameWork) {
    const Folder folder;
    fs::create_directories(folder.path);
    const std::string file = (folder.path / "small.glb").string();
    const std::string record = "\"" RAYCONTACT_PROGRAM_FILE "\" run avalanche --bodies 8 --steps 60 --json --record \""
                               + file + "\" >/dev/null 2>&1";
    ASSERT_EQ(std::system(record.c_str()), 0);
    const std::string how = "peers --works avalanche --only bvh --bodies 8 --avalanche-first 40 --avalanche-steps 20 "
                            "--avalanche-stride 5 --runs 1 --json";
    const Ran here = run(how), recorded = run(how + " --recording \"" + file + "\"");
    ASSERT_EQ(here.status, 0);
    ASSERT_EQ(recorded.status, 0);
    const Json one = Json::parse(here.out)["results"][0], two = Json::parse(recorded.out)["results"][0];
    EXPECT_EQ(one["steps"], 4);
    EXPECT_GT(one["contacts"], 0);
    EXPECT_EQ(one["hash"], two["hash"]); // the poses are the same bits, whoever found the pairs
}

TEST(BenchPeers, BadUsage) {
    for (const char* arguments :
         {"", "peers --only nobody", "peers --works nothing", "peers --mesh /no/such.obj",
          "peers --works avalanche --recording /no/such.glb", "peers --runs 0", "growth --pairs 0"}) {
        const Ran ran = run(arguments, true);
        EXPECT_EQ(ran.status, 2) << arguments << ": " << ran.out;
        EXPECT_EQ(std::count(ran.out.begin(), ran.out.end(), '\n'), 1) << arguments << ": " << ran.out;
    }
}

TEST(BenchGrowth, BothParts) {
    const Folder folder;
    const Ran ran =
        run("growth --bodies 64 --steps 30 --triangles 316 --pairs 2 --json --out \"" + folder.path.string() + "\"");
    ASSERT_EQ(ran.status, 0);
    const Json rows = Json::parse(ran.out)["rows"];
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_EQ(rows[0]["part"], "triangles");
    EXPECT_EQ(rows[2]["part"], "bodies");
    EXPECT_EQ(rows[2]["size"], 64);
    EXPECT_GT(rows[2]["narrow_ms"], 0);
    EXPECT_NE(content(file_with(folder.path, "growth-", ".csv")).find("triangles,316"), std::string::npos);
    EXPECT_TRUE(content(file_with(folder.path, "growth-", ".svg")).starts_with("<svg"));
}
