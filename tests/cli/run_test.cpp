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
    for (const char* key : {"scene",
                            "seed",
                            "steps",
                            "bodies",
                            "pairs_max",
                            "rays",
                            "contacts",
                            "ray_length",
                            "penetration_max",
                            "wall_ms",
                            "step_ms",
                            "narrow_ms",
                            "method",
                            "caster",
                            "direction",
                            "devices",
                            "device_choice",
                            "schedule",
                            "hash",
                            "rays_cast",
                            "walks",
                            "walks_lost",
                            "walk_casts",
                            "predictions",
                            "pairs_full",
                            "pairs_skipped",
                            "pairs_as_standard",
                            "pair_bytes_max",
                            "contacts_new",
                            "contacts_lost",
                            "displacement_threshold",
                            "confidence",
                            "culling_distance",
                            "distance_extension",
                            "max_iterations",
                            "cast_lost_walks",
                            "max_contacts_per_pair",
                            "max_contacts",
                            "contacts_reduced"}) {
        EXPECT_TRUE(run_log.contains(key)) << key;
    }
    for (const char* key : {"step_ms", "narrow_ms"}) {
        EXPECT_TRUE(run_log[key].contains("median")) << key;
        EXPECT_TRUE(run_log[key].contains("p95")) << key;
    }
    EXPECT_GT(run_log["narrow_ms_last_second"].get<double>(), 0);
    EXPECT_LE(run_log["narrow_ms_last_second"].get<double>(), run_log["wall_ms"].get<double>());
    EXPECT_EQ(run_log["scene"], "avalanche");
    EXPECT_EQ(run_log["seed"], 7);
    EXPECT_EQ(run_log["steps"], 90);
    EXPECT_EQ(run_log["bodies"], 8);
    EXPECT_EQ(run_log["method"], "certified");
    EXPECT_EQ(run_log["caster"], "bvh");
    EXPECT_EQ(run_log["direction"], "reprojected");
    EXPECT_GT(run_log["contacts"].get<int>(), 0); // they have landed
    EXPECT_GE(run_log["rays"].get<int>(), run_log["contacts"].get<int>());
    EXPECT_GT(run_log["penetration_max"].get<double>(), 0);
    EXPECT_GT(run_log["pairs_full"].get<int>(), 0);
    EXPECT_GT(run_log["pairs_skipped"].get<int>(), 0); // while they fall side by side
    EXPECT_GT(run_log["pair_bytes_max"].get<int>(), 0);
    EXPECT_EQ(run_log["walks"], 0);
    // Each contact comes once before it goes, and some are there at the end.
    EXPECT_GT(run_log["contacts_new"].get<int>(), run_log["contacts_lost"].get<int>());
    EXPECT_LE(run_log["contacts_new"].get<int>(), run_log["contacts"].get<int>());
    EXPECT_TRUE(run_log["displacement_threshold"].is_null());
    EXPECT_EQ(run_log["cast_lost_walks"], true);
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

TEST_F(Run, CertifiedAndStandardRunAlike) {
    const json certified = run({}), standard = run({"--method", "standard"});
    EXPECT_EQ(standard["method"], "standard");
    EXPECT_EQ(standard["pairs_skipped"], 0);
    for (const char* key : {"hash", "contacts", "contacts_new", "contacts_lost", "ray_length", "pairs_max"})
        EXPECT_EQ(certified[key], standard[key]) << key;
    EXPECT_LT(certified["rays_cast"].get<int>(), standard["rays_cast"].get<int>());
    EXPECT_EQ(run({"--displacement-threshold", "0.05", "--max-iterations", "3"})["hash"], standard["hash"]);
}

TEST_F(Run, TellsItsSettings) {
    const json log = run({"--method", "predictive", "--displacement-threshold", "0.0125", "--confidence", "3",
                          "--culling-distance", "0.03", "--distance-extension", "0.025", "--max-iterations", "7",
                          "--no-walk-casts", "--speculative", "0.02", "--features", "vertices"});
    EXPECT_EQ(log["speculative"], 0.02);
    EXPECT_GT(log["contacts_speculative"], 0);
    EXPECT_EQ(log["features"], "vertices");
    EXPECT_EQ(log["method"], "predictive");
    EXPECT_EQ(log["displacement_threshold"], 0.0125);
    EXPECT_EQ(log["confidence"], 3);
    EXPECT_EQ(log["culling_distance"], 0.03);
    EXPECT_EQ(log["distance_extension"], 0.025);
    EXPECT_EQ(log["max_iterations"], 7);
    EXPECT_EQ(log["cast_lost_walks"], false);
}

// Bullet's manifolds are made of the same points, more or less: the pile lies as it does with all contacts. How deep
// its bodies of 1 m are on their way down differs from machine to machine.
TEST_F(Run, FewerContactsAreCounted) {
    const json all = run({}), few = run({"--max-contacts-per-pair", "8"});
    EXPECT_EQ(few["max_contacts_per_pair"], 8);
    EXPECT_EQ(all["contacts_reduced"], 0);
    EXPECT_GT(few["contacts_reduced"].get<int>(), few["contacts"].get<int>() / 4);
    EXPECT_LT(all["penetration_max"].get<double>(), 0.05);
    EXPECT_LT(few["penetration_max"].get<double>(), 0.05);
    EXPECT_EQ(run({"--max-contacts-per-pair", "8", "--method", "standard"})["hash"], few["hash"]);
}

TEST_F(Run, OutHoldsTheReport) {
    const json log = run({"--out", "made/for/it"});
    const auto report = folder_.path() / "made/for/it/report.html";
    ASSERT_TRUE(std::filesystem::is_regular_file(report));
    EXPECT_GT(std::filesystem::file_size(report), 10000u);
    const auto rows = csv_rows(folder_.path() / "made/for/it/steps.csv");
    EXPECT_EQ(rows.size(), 90u);
    for (const char* column :
         {"pairs", "rays", "contacts", "step_ms", "narrow_ms", "ray_length_m", "penetration_max_m", "median_speed_m_s"})
        EXPECT_TRUE(rows.front().contains(column)) << column;
    for (const char* column : {"rays", "rays_cast", "contacts", "walks", "walks_lost", "walk_casts", "predictions",
                               "pairs_full", "pairs_skipped", "pairs_as_standard", "contacts_new", "contacts_lost"})
        EXPECT_EQ(sum_of(rows, column), log[column].get<double>()) << column;
    EXPECT_EQ(largest_of(rows, "pair_bytes"), log["pair_bytes_max"].get<double>());
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
    for (const char* file : {"pile.bin", "pile", "glb", ".glb", "pile.glb/", "pile.glb.part", ""})
        refused({"avalanche", "--bodies", "8", "--steps", "2", "--record", file}, "--record");
    folder_.write("file", "");
    refused({"avalanche", "--bodies", "8", "--steps", "2", "--out", "file"}, "file");
}

} // namespace
