// SPDX-License-Identifier: Apache-2.0
// `run --record` and `replay` through the program: keys, hash, exit status.
#include "program.h"
#include "sample.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

using nlohmann::json;
using raycontact::recording::BlockType;

namespace {

class ReplayProgram : public testing::Test {
protected:
    json record(const std::string& file, const std::vector<std::string>& more = {}) const {
        return recorded({"avalanche", "--bodies", "8", "--steps", "60", "--record", file}, more);
    }
    json recorded(std::vector<std::string> words, const std::vector<std::string>& more) const {
        words.insert(words.begin(), "run");
        words.insert(words.end(), more.begin(), more.end());
        words.emplace_back("--json");
        const auto result = run_program(words, folder_.path());
        EXPECT_EQ(result.status, 0) << result.err;
        return json::parse(result.out);
    }
    ProgramResult replay(std::vector<std::string> words) const {
        words.insert(words.begin(), "replay");
        return run_program(words, folder_.path());
    }
    json replayed(std::vector<std::string> words) const {
        words.emplace_back("--json");
        const auto result = replay(words);
        EXPECT_EQ(result.status, 0) << result.err;
        EXPECT_EQ(result.err, "");
        return json::parse(result.out);
    }
    std::string text_of(const std::string& file) const {
        const auto bytes = bytes_of(folder_.path() / file);
        return {bytes.begin(), bytes.end()};
    }
    TemporaryFolder folder_;
};

class ReplayOfMethod : public ReplayProgram, public testing::WithParamInterface<const char*> {};

const std::vector<std::string> settings_keys{"method",
                                             "caster",
                                             "direction",
                                             "displacement_threshold",
                                             "confidence",
                                             "culling_distance",
                                             "distance_extension",
                                             "max_iterations",
                                             "cast_lost_walks",
                                             "max_contacts_per_pair",
                                             "max_contacts"};
const std::vector<std::string> summed{
    "rays",         "rays_cast",     "contacts",        "walks",         "walks_lost",
    "walk_casts",   "predictions",   "pairs_full",      "pairs_skipped", "pairs_as_standard",
    "contacts_new", "contacts_lost", "contacts_reduced"};

} // namespace

TEST_P(ReplayOfMethod, ReproducesTheHash) {
    const json run = record("a.glb", {"--method", GetParam()});
    const json all_rays = replayed({"a.glb", "--method", "standard"});
    for (const char* other : {"", "--caster=basic", "--threads=1"}) {
        std::vector<std::string> words{"a.glb", "--compare", "standard"};
        if (*other != 0) words.emplace_back(other);
        const json again = replayed(words);
        for (const char* key :
             {"scene", "seed", "steps", "bodies", "pairs_max", "contacts", "ray_length", "penetration_max", "method",
              "direction", "features", "devices", "hash", "contacts_new", "contacts_lost"})
            EXPECT_EQ(again.at(key), run.at(key)) << key;
        for (const char* key : {"wall_ms", "step_ms", "narrow_ms", "caster", "pair_bytes_max", "rays"})
            EXPECT_TRUE(again.contains(key)) << key;
        EXPECT_EQ(again.at("recorded_method"), GetParam());
        EXPECT_EQ(again.at("recorded_hash"), run.at("hash"));
        EXPECT_EQ(again.at("hash_reproduced"), true);
        EXPECT_EQ(again.at("hash_expected"), true);
        EXPECT_EQ(again.at("rays_compared"), all_rays.at("rays"));
        EXPECT_EQ(again.at("contacts_compared"), all_rays.at("contacts"));
        EXPECT_EQ(again.at("wrong_rays").at("total") == 0, run.at("hash") == all_rays.at("hash"));
    }
    // The same settings: the same work. (Where bodies were expected is not recorded.)
    const json plain = record("b.glb", {"--method", GetParam(), "--speculative", "off"});
    const json again = replayed({"b.glb"});
    for (const std::string& key : summed) EXPECT_EQ(again.at(key), plain.at(key)) << key;
    EXPECT_EQ(again.at("pair_bytes_max"), plain.at("pair_bytes_max"));
    EXPECT_GT(run.at("contacts_speculative"), 0);
    EXPECT_GT(replayed({"a.glb", "--speculative", "auto"}).at("contacts_speculative"), 0);
    const json turned = replayed({"a.glb", "--direction", "ray"});
    EXPECT_EQ(turned.at("hash_reproduced"), false);
    EXPECT_EQ(turned.at("hash_expected"), false);
    EXPECT_NE(replay({"a.glb"}).out.find("as recorded"), std::string::npos);
}

TEST_F(ReplayProgram, ReproducesTheHashOfAWeightedRun) {
    const json run = record("a.glb", {"--direction", "weighted"});
    EXPECT_EQ(run.at("direction"), "weighted");
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"a.glb"}, {"a.glb", "--method", "standard"}, {"a.glb", "--caster", "basic"}}) {
        const json again = replayed(words);
        EXPECT_EQ(again.at("direction"), "weighted");
        EXPECT_EQ(again.at("hash"), run.at("hash"));
        EXPECT_EQ(again.at("hash_expected"), true);
    }
    const json ray = replayed({"a.glb", "--direction", "ray"});
    EXPECT_NE(ray.at("hash"), run.at("hash"));
    EXPECT_EQ(ray.at("hash_expected"), false);
}

TEST_F(ReplayProgram, ReproducesTheHashOfARunOfVertices) {
    std::ofstream(folder_.path() / "cube.obj") << cube_obj(); // the edges of finer meshes add nothing
    const json run = recorded({"--mesh", "cube.obj", "--bodies", "27", "--steps", "90", "--record", "a.glb"},
                              {"--features", "vertices"});
    const json again = replayed({"a.glb"});
    EXPECT_EQ(again.at("features"), "vertices");
    EXPECT_EQ(again.at("recorded_features"), "vertices");
    EXPECT_EQ(again.at("hash"), run.at("hash"));
    EXPECT_EQ(again.at("hash_expected"), true);
    const json edges = replayed({"a.glb", "--features", "edges"});
    EXPECT_NE(edges.at("hash"), run.at("hash"));
    EXPECT_EQ(edges.at("hash_expected"), false);
    const auto text = replay({"a.glb", "--features", "edges"});
    EXPECT_NE(text.out.find("with other settings (method certified, direction reprojected, features vertices)"),
              std::string::npos)
        << text.out;
}

TEST_P(ReplayOfMethod, UsesTheRecordedSettingsUnlessOthersAreGiven) {
    const json run = record("a.glb", {"--method", GetParam(), "--displacement-threshold", "0.0125", "--confidence",
                                      "1.5", "--culling-distance", "0.03", "--distance-extension", "0.025",
                                      "--max-iterations", "3", "--no-walk-casts", "--caster", "basic"});
    const json again = replayed({"a.glb"});
    for (const std::string& key : settings_keys) EXPECT_EQ(again.at(key), run.at(key)) << key;
    EXPECT_EQ(again.at("hash"), run.at("hash"));
    const json other =
        replayed({"a.glb", "--displacement-threshold", "auto", "--confidence", "4", "--culling-distance", "0.5",
                  "--distance-extension", "auto", "--max-iterations", "9", "--walk-casts", "--caster", "bvh"});
    EXPECT_EQ(other.at("method"), GetParam());
    EXPECT_EQ(other.at("caster"), "bvh");
    EXPECT_TRUE(other.at("displacement_threshold").is_null());
    EXPECT_EQ(other.at("confidence"), 4);
    EXPECT_EQ(other.at("culling_distance"), 0.5);
    EXPECT_TRUE(other.at("distance_extension").is_null());
    EXPECT_EQ(other.at("max_iterations"), 9);
    EXPECT_EQ(other.at("cast_lost_walks"), true);
    // With what was recorded it makes no sense.
    const auto result = replay({"a.glb", "--displacement-threshold", "0.026"});
    EXPECT_EQ(result.status, 2);
    EXPECT_NE(result.err.find("--distance-extension"), std::string::npos) << result.err;
}

TEST_P(ReplayOfMethod, WritesItsSteps) {
    record("a.glb", {"--method", GetParam()});
    const json compared = replayed({"a.glb", "--compare", "standard", "--out", "made/for/it"});
    const std::filesystem::path folder = folder_.path() / "made/for/it";
    auto rows = csv_rows(folder / "steps.csv");
    ASSERT_EQ(rows.size(), 60u);
    EXPECT_EQ(rows.back().at("step"), 59);
    for (const std::string& column : summed)
        EXPECT_EQ(sum_of(rows, column), compared.at(column).get<double>()) << column;
    for (const char* column : {"missed", "invented", "other_triangle"})
        EXPECT_EQ(sum_of(rows, column), compared.at("wrong_rays").at(column).get<double>()) << column;
    for (const char* column : {"rays_compared", "contacts_compared"})
        EXPECT_EQ(sum_of(rows, column), compared.at(column).get<double>()) << column;
    EXPECT_EQ(largest_of(rows, "pairs"), compared.at("pairs_max").get<double>());
    EXPECT_EQ(largest_of(rows, "pair_bytes"), compared.at("pair_bytes_max").get<double>());
    EXPECT_GT(sum_of(rows, "narrow_ms"), 0);
    for (const char* file : {"narrow_ms.svg", "wrong_rays.svg"}) {
        const std::string svg = text_of(std::string("made/for/it/") + file);
        EXPECT_TRUE(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\"")) << file;
        EXPECT_TRUE(svg.ends_with("</svg>\n")) << file;
        EXPECT_NE(svg.find(std::string("method ") + GetParam()), std::string::npos) << file;
        EXPECT_NE(svg.find("<path class=\"line s0\" d=\"M"), std::string::npos) << file;
    }

    replayed({"a.glb", "--out", "alone"});
    rows = csv_rows(folder_.path() / "alone/steps.csv");
    ASSERT_EQ(rows.size(), 60u);
    for (const char* column : {"rays_compared", "contacts_compared", "missed", "invented", "other_triangle"})
        EXPECT_FALSE(rows[0].contains(column)) << column;
    EXPECT_EQ(sum_of(rows, "rays_cast"), compared.at("rays_cast").get<double>());
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "alone/narrow_ms.svg"));
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "alone/wrong_rays.svg"));
}

INSTANTIATE_TEST_SUITE_P(Methods, ReplayOfMethod, testing::Values("standard", "iterative", "predictive", "certified"),
                         [](const auto& test) { return std::string(test.param); });

TEST_F(ReplayProgram, StandardAndCertifiedReproduceEachOther) {
    for (const char* method : {"standard", "certified"}) {
        const json run = record("a.glb", {"--method", method});
        for (const char* other : {"standard", "certified"}) {
            const json again = replayed({"a.glb", "--method", other, "--displacement-threshold", "0.02"});
            EXPECT_EQ(again.at("method"), other);
            EXPECT_EQ(again.at("recorded_method"), method);
            EXPECT_EQ(again.at("hash"), run.at("hash"));
            EXPECT_EQ(again.at("hash_expected"), true);
        }
    }
    EXPECT_NE(replay({"a.glb", "--method", "standard"}).out.find("as recorded with method certified"),
              std::string::npos);
}

TEST_F(ReplayProgram, ContactsThatShouldBeTheRunsAndAreNotAreStatus1) {
    record("a.glb", {"--method", "predictive"});
    edit_json(folder_.path() / "a.glb", BlockType::end, [](auto& end) { end["hash"] = "0123456789abcdef"; });
    const auto result = replay({"a.glb", "--json"});
    EXPECT_EQ(result.status, 1);
    EXPECT_NE(result.err.find("a.glb: the recorded hash was not reproduced"), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    const json found = json::parse(result.out); // what was found is told nevertheless
    EXPECT_EQ(found.at("recorded_hash"), "0123456789abcdef");
    EXPECT_EQ(found.at("hash_reproduced"), false);
    EXPECT_EQ(replay({"a.glb", "--caster", "basic"}).status, 1);
    // Other settings promise nothing.
    for (const std::vector<std::string>& other : {std::vector<std::string>{"--method", "standard"},
                                                  {"--method", "iterative"},
                                                  {"--direction", "ray"},
                                                  {"--displacement-threshold", "0.01"},
                                                  {"--no-walk-casts"}}) {
        auto words = other;
        words.insert(words.begin(), "a.glb");
        EXPECT_EQ(replayed(words).at("hash_expected"), false) << other[0];
    }
}

TEST_F(ReplayProgram, OldRecordingsAreRead) {
    const json run = record("a.glb", {"--method", "standard"});
    edit_json(folder_.path() / "a.glb", BlockType::info, [](auto& info) {
        for (const char* key :
             {"displacement_threshold", "confidence", "culling_distance", "distance_extension", "max_iterations",
              "cast_lost_walks", "skip_outside", "max_contacts_per_pair", "max_contacts"})
            info.erase(key);
    });
    const json again = replayed({"a.glb"});
    for (const std::string& key : settings_keys) EXPECT_EQ(again.at(key), run.at(key)) << key;
    EXPECT_EQ(again.at("hash_reproduced"), true);
}

TEST_F(ReplayProgram, IsAMeshFileToo) {
    record("a.glb");
    const auto result = run_program({"mesh", "a.glb", "--json"}, folder_.path());
    EXPECT_EQ(result.status, 0) << result.err;
}

TEST_F(ReplayProgram, ContactsLeftOutAreLeftOutAgain) {
    const json run = record("a.glb", {"--max-contacts-per-pair", "2", "--speculative", "off"});
    EXPECT_GT(run.at("contacts_reduced").get<int>(), 0);
    EXPECT_EQ(replayed({"a.glb"}).at("hash_reproduced"), true);
    const json all = replayed({"a.glb", "--max-contacts-per-pair", "0"});
    EXPECT_EQ(all.at("hash_expected"), false);
    EXPECT_EQ(all.at("contacts"), run.at("contacts").get<int>() + run.at("contacts_reduced").get<int>());
    const auto compared = replay({"a.glb", "--compare", "standard"});
    EXPECT_EQ(compared.status, 2);
    EXPECT_NE(compared.err.find("--max-contacts-per-pair 0"), std::string::npos) << compared.err;
    EXPECT_EQ(replay({"a.glb", "--compare", "standard", "--max-contacts-per-pair", "0"}).status, 0);
}

TEST_F(ReplayProgram, BadInputIsStatus2) {
    record("a.glb");
    for (const char* copy : {"later.glb", "whole.glb"})
        std::filesystem::copy_file(folder_.path() / "a.glb", folder_.path() / copy);
    edit_json(folder_.path() / "later.glb", BlockType::info, [](auto& info) { info["method"] = "wavelet"; });
    std::filesystem::resize_file(folder_.path() / "a.glb", std::filesystem::file_size(folder_.path() / "a.glb") / 2);
    folder_.write("text.glb", "this is not a recording at all");
    for (const std::vector<std::string>& words : {std::vector<std::string>{"a.glb"},
                                                  {"text.glb"},
                                                  {"missing.glb"},
                                                  {"."},
                                                  {"a.glb", "--compare", "other"},
                                                  {"later.glb"},
                                                  {"whole.glb", "--out", "text.glb"},
                                                  {}}) {
        const auto result = replay(words);
        EXPECT_EQ(result.status, 2);
        EXPECT_EQ(result.out, "");
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
    EXPECT_NE(replay({"later.glb"})
                  .err.find("later.glb: was recorded with a setting this version does not know: method "
                            "'wavelet'"),
              std::string::npos);
    folder_.write("file", "no folder can be made here");
    const auto result =
        run_program({"run", "avalanche", "--bodies", "1", "--steps", "1", "--record", "file/a.glb"}, folder_.path());
    EXPECT_EQ(result.status, 2);
    EXPECT_NE(result.err.find("file/a.glb"), std::string::npos);
}
