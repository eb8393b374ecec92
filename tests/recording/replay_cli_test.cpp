// SPDX-License-Identifier: Apache-2.0
// `run --record` and `replay` through the program: keys, hash, exit status.
#include "program.h"

#include <gtest/gtest.h>

#include <filesystem>

using nlohmann::json;

namespace {

class ReplayProgram : public testing::Test {
protected:
    json record(const std::string& file) const {
        const auto result = run_program(
            {"run", "avalanche", "--bodies", "8", "--steps", "60", "--record", file, "--json"}, folder_.path());
        EXPECT_EQ(result.status, 0) << result.err;
        return json::parse(result.out);
    }
    ProgramResult replay(std::vector<std::string> words) const {
        words.insert(words.begin(), "replay");
        return run_program(words, folder_.path());
    }
    TemporaryFolder folder_;
};

} // namespace

TEST_F(ReplayProgram, ReproducesTheHash) {
    const json run = record("a.glb");
    for (const char* caster : {"", "--caster=basic", "--threads=1"}) {
        std::vector<std::string> words{"a.glb", "--json", "--compare", "standard"};
        if (*caster != 0) words.push_back(caster);
        const auto result = replay(words);
        ASSERT_EQ(result.status, 0) << result.err;
        const json replayed = json::parse(result.out);
        for (const char* key : {"scene", "seed", "steps", "bodies", "pairs_max", "rays", "contacts", "ray_length",
                                "penetration_max", "method", "direction", "devices", "hash"})
            EXPECT_EQ(replayed.at(key), run.at(key)) << key;
        for (const char* key : {"wall_ms", "step_ms", "narrow_ms", "caster"})
            EXPECT_TRUE(replayed.contains(key)) << key;
        EXPECT_EQ(replayed.at("recorded_hash"), run.at("hash"));
        EXPECT_EQ(replayed.at("hash_reproduced"), true);
        EXPECT_EQ(replayed.at("wrong_rays").at("total"), 0);
        EXPECT_EQ(replayed.at("rays_compared"), run.at("rays"));
        EXPECT_EQ(replayed.at("contacts_compared"), run.at("contacts"));
    }
    EXPECT_EQ(json::parse(replay({"a.glb", "--json", "--direction", "ray"}).out).at("hash_reproduced"), false);
    EXPECT_NE(replay({"a.glb"}).out.find("as recorded"), std::string::npos);
}

TEST_F(ReplayProgram, IsAMeshFileToo) {
    record("a.glb");
    const auto result = run_program({"mesh", "a.glb", "--json"}, folder_.path());
    EXPECT_EQ(result.status, 0) << result.err;
}

TEST_F(ReplayProgram, BadInputIsStatus2) {
    record("a.glb");
    std::filesystem::resize_file(folder_.path() / "a.glb", std::filesystem::file_size(folder_.path() / "a.glb") / 2);
    folder_.write("text.glb", "this is not a recording at all");
    for (const std::vector<std::string>& words : {std::vector<std::string>{"a.glb"},
                                                  {"text.glb"},
                                                  {"missing.glb"},
                                                  {"."},
                                                  {"a.glb", "--compare", "other"},
                                                  {}}) {
        const auto result = replay(words);
        EXPECT_EQ(result.status, 2);
        EXPECT_EQ(result.out, "");
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
    const auto result =
        run_program({"run", "avalanche", "--bodies", "1", "--steps", "1", "--record", "no/such/a.glb"}, folder_.path());
    EXPECT_EQ(result.status, 2);
    EXPECT_NE(result.err.find("no/such/a.glb"), std::string::npos);
}
