// SPDX-License-Identifier: Apache-2.0
// `run`: its keys, its files, its hash, on an avalanche of a few bodies.
#include "expect.h"

#include <algorithm>
#include <cctype>

namespace {

using nlohmann::json;

class Run : public testing::Test {
protected:
    json run(std::vector<std::string> more) const {
        std::vector<std::string> words{"run", "avalanche", "--bodies", "8", "--steps", "90", "--json"};
        words.insert(words.end(), more.begin(), more.end());
        const auto result = run_program(words, folder_.path());
        EXPECT_EQ(result.status, 0) << result.err;
        return json::parse(result.out);
    }
    TemporaryFolder folder_;
};

TEST_F(Run, HasItsKeys) {
    const json run_log = run({"--seed", "7"});
    for (const char* key :
         {"scene", "seed", "steps", "bodies", "pairs_max", "rays", "contacts", "ray_length", "penetration_max",
          "wall_ms", "step_ms", "narrow_ms", "method", "caster", "direction", "devices", "hash"}) {
        EXPECT_TRUE(run_log.contains(key)) << key;
    }
    for (const char* key : {"step_ms", "narrow_ms"}) {
        EXPECT_TRUE(run_log[key].contains("median")) << key;
        EXPECT_TRUE(run_log[key].contains("p95")) << key;
    }
    EXPECT_EQ(run_log["scene"], "avalanche");
    EXPECT_EQ(run_log["seed"], 7);
    EXPECT_EQ(run_log["steps"], 90);
    EXPECT_EQ(run_log["bodies"], 8);
    EXPECT_EQ(run_log["method"], "standard");
    EXPECT_EQ(run_log["caster"], "bvh");
    EXPECT_EQ(run_log["direction"], "reprojected");
    EXPECT_GT(run_log["contacts"].get<int>(), 0); // they have landed
    EXPECT_GE(run_log["rays"].get<int>(), run_log["contacts"].get<int>());
    EXPECT_GT(run_log["penetration_max"].get<double>(), 0);
    const auto hash = run_log["hash"].get<std::string>();
    EXPECT_EQ(hash.size(), 16u);
    EXPECT_TRUE(std::all_of(hash.begin(), hash.end(), [](unsigned char c) { return std::isxdigit(c) != 0; })) << hash;
}

TEST_F(Run, SameSeedSameHash) {
    const auto hash = run({})["hash"];
    EXPECT_EQ(run({})["hash"], hash);
    EXPECT_EQ(run({"--caster", "basic"})["hash"], hash);
    EXPECT_EQ(run({"--threads", "1"})["hash"], hash);
    EXPECT_EQ(run({"--threads", "3"})["hash"], hash);
    EXPECT_NE(run({"--seed", "12345"})["hash"], hash);
}

TEST_F(Run, OutHoldsTheReport) {
    run({"--out", "made/for/it"});
    const auto report = folder_.path() / "made/for/it/report.html";
    ASSERT_TRUE(std::filesystem::is_regular_file(report));
    EXPECT_GT(std::filesystem::file_size(report), 10000u);
    EXPECT_TRUE(std::filesystem::is_regular_file(folder_.path() / "made/for/it/steps.csv"));
}

TEST_F(Run, BadUsage) {
    const auto refused = [&](std::vector<std::string> words, const std::string& named) {
        words.insert(words.begin(), "run");
        expect_refused(run_program(words, folder_.path()), named);
    };
    refused({}, "SCENE");
    refused({"landslide"}, "landslide");
    refused({"avalanche", "--steps", "0"}, "--steps");
    refused({"avalanche", "--steps", "many"}, "--steps");
    refused({"avalanche", "--bodies", "-3"}, "--bodies");
    refused({"avalanche", "--seed", "x"}, "--seed");
    refused({"avalanche", "--method", "quick"}, "--method");
    refused({"avalanche", "--devices", "cuda:77"}, "cuda:77");
    folder_.write("file", "");
    refused({"avalanche", "--bodies", "8", "--steps", "2", "--out", "file"}, "file");
}

} // namespace
