// SPDX-License-Identifier: Apache-2.0
// Pairs files that are not what they should be: each gives status 2, no output, and one line that says where.
#include "../time_limit.h"
#include "expect.h"

#include <sys/stat.h>

namespace {

struct Hostile {
    const char* name;
    std::string text;
    const char* named; ///< must be in the message, besides the file
};

const std::string files = R"("a": "cube.obj", "b": "cube.obj")";
const std::string good = "{" + files + "}";
const std::string zeros16 = "0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0";

std::string pair_with(const std::string& more) {
    return "[" + good + ", {" + files + ", " + more + "}]";
}

std::string pose(const std::string& numbers) {
    return pair_with("\"pose_b\": [" + numbers + "]");
}

std::vector<Hostile> hostile_files() {
    return {
        {"empty", "", "JSON"},
        {"truncated", "[" + good + ", {\"a\": \"cube", "JSON"},
        {"not_json", "a: cube.obj\n", "line 1"},
        {"trailing", "[" + good + "] more", "JSON"},
        {"binary", std::string("\0\1\2\3\xff\xfe", 6), "JSON"},
        {"bad_utf8", "[{\"a\": \"\xff\xfe\", \"b\": \"cube.obj\"}]", "JSON"},
        {"nested", std::string(1000000, '['), "nested"},
        {"nested_pose", pair_with("\"pose_a\": [[[[[[[1]]]]]]]"), "nested"},
        {"root_object", good, "array"},
        {"root_number", "7", "array"},
        {"pair_is_a_number", "[" + good + ", 3]", "pair 1"},
        {"pair_is_a_list", "[" + good + ", []]", "pair 1"},
        {"pair_is_null", "[null]", "pair 0"},
        {"missing_b", "[" + good + ", {\"a\": \"cube.obj\"}]", "\"b\""},
        {"a_is_a_number", "[{\"a\": 3, \"b\": \"cube.obj\"}]", "pair 0, a"},
        {"a_is_empty", "[{\"a\": \"\", \"b\": \"cube.obj\"}]", "pair 0, a"},
        {"a_has_a_zero_byte", "[{\"a\": \"cube.obj\\u0000.txt\", \"b\": \"cube.obj\"}]", "pair 0, a"},
        {"no_such_mesh", "[" + good + ", {\"a\": \"cube.obj\", \"b\": \"missing.obj\"}]", "pair 1, b"},
        {"mesh_is_a_folder", "[" + good + ", {\"a\": \".\", \"b\": \"cube.obj\"}]", "pair 1, a"},
        {"mesh_is_bad", "[" + good + ", {\"a\": \"bad.obj\", \"b\": \"cube.obj\"}]", "bad.obj"},
        {"unknown_key", pair_with("\"pose_c\": []"), "pose_c"},
        {"misspelt_key", pair_with("\"pose_A\": []"), "pose_A"},
        {"key_of_two_lines", pair_with("\"po\\nse\": []"), "pair 1"},
        {"key_twice", pair_with("\"scale_a\": 1, \"scale_a\": 2"), "twice"},
        {"pose_is_a_string", pair_with("\"pose_a\": \"identity\""), "pair 1, pose_a"},
        {"pose_is_an_object", pair_with("\"pose_a\": {}"), "pair 1, pose_a"},
        {"pose_is_null", pair_with("\"pose_a\": null"), "pair 1, pose_a"},
        {"pose_of_15", pose("1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0"), "has 15"},
        {"pose_of_17", pose("1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1,0"), "has 17"},
        {"pose_of_none", pose(""), "has 0"},
        {"pose_with_a_word", pose("1,0,0,0, 0,1,0,0, 0,0,1,\"0\", 0,0,0,1"), "entry 11"},
        {"pose_with_true", pose("true,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1"), "entry 0"},
        {"pose_with_nan", pose("NaN,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1"), "JSON"},
        {"pose_with_infinity", pose("1,0,0,1e999, 0,1,0,0, 0,0,1,0, 0,0,0,1"), "1e999"},
        {"pose_of_zeros", pose(zeros16), "pair 1, pose_b"},
        {"pose_sheared", pose("1,0.1,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1"), "pair 1, pose_b"},
        {"pose_sheared_a_little", pose("1,0.0005,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1"), "pair 1, pose_b"},
        {"pose_scaled", pose("2,0,0,0, 0,2,0,0, 0,0,2,0, 0,0,0,1"), "pair 1, pose_b"},
        {"pose_mirrored", pose("-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1"), "pair 1, pose_b"},
        {"pose_column_major", pose("1,0,0,0, 0,1,0,0, 0,0,1,0, 3,4,5,1"), "pair 1, pose_b"},
        {"pose_projective", pose("1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,2"), "pair 1, pose_b"},
        {"pose_huge", pose("1e308,0,0,0, 0,1e308,0,0, 0,0,1e308,0, 0,0,0,1"), "pair 1, pose_b"},
        {"scale_zero", pair_with("\"scale_a\": 0"), "pair 1, scale_a"},
        {"scale_negative", pair_with("\"scale_b\": -1"), "pair 1, scale_b"},
        {"scale_is_a_list", pair_with("\"scale_b\": [1, 1, 1]"), "pair 1, scale_b"},
        {"scale_is_true", pair_with("\"scale_b\": true"), "pair 1, scale_b"},
        {"scale_beyond_float", pair_with("\"scale_b\": 1e300"), "pair 1, b"},
        {"scale_vanishing", pair_with("\"scale_b\": 1e-320"), "pair 1, b"},
    };
}

class HostilePairs : public testing::TestWithParam<Hostile> {};

TEST_P(HostilePairs, IsRefusedInOneLine) {
    const TemporaryFolder folder;
    folder.write("cube.obj", cube_obj());
    folder.write("bad.obj", "v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n");
    folder.write("hostile.json", GetParam().text);
    const auto result = run_program({"collide", "--pairs", "hostile.json", "--json"}, folder.path());
    expect_refused(result, "hostile.json");
    EXPECT_NE(result.err.find(GetParam().named), std::string::npos) << GetParam().named << " is not in: " << result.err;
}

INSTANTIATE_TEST_SUITE_P(Files, HostilePairs, testing::ValuesIn(hostile_files()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(HostilePairsFile, MissingFolderAndUnreadable) {
    const TemporaryFolder folder;
    ASSERT_EQ(::mkfifo((folder.path() / "pipe.json").c_str(), 0600), 0);
    expect_refused(run_program({"collide", "--pairs", "pipe.json"}, folder.path()), "pipe.json: is not an ordinary");
    expect_refused(run_program({"run", "pipe.json"}, folder.path()), "pipe.json: is not an ordinary");
    expect_refused(run_program({"collide", "--pairs", "/dev/zero"}, folder.path()), "/dev/zero: is not an ordinary");
    std::filesystem::create_directory(folder.path() / "folder.json");
    std::filesystem::create_symlink("nowhere", folder.path() / "dangling.json");
    for (const char* file : {"missing.json", "folder.json", "dangling.json"}) {
        expect_refused(run_program({"collide", "--pairs", file, "--json"}, folder.path()), file);
    }
}

TEST(HostilePairsFile, ManyPairsAreReadInLinearTime) {
    const TemporaryFolder folder;
    folder.write("cube.obj", cube_obj());
    std::string text = "[";
    for (int i = 0; i < 300000; ++i) text += good + ",";
    folder.write("many.json", text + "{}]");
    const TimeLimit limit(20); // some minutes where it is not
    expect_refused(run_program({"collide", "--pairs", "many.json"}, folder.path()), "pair 300000: the key \"a\"");
}

TEST(HostilePairsFile, BeyondAGigabyteIsRefusedUnread) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer needs terabytes of addresses";
#endif
    const TemporaryFolder folder;
    std::filesystem::resize_file(folder.write("large.json", "["), (std::uintmax_t{1} << 30) + 1); // takes no room
    // With less memory than it would take to read it.
    expect_refused(run_limited("-v 900000", {"collide", "--pairs", "large.json"}, folder.path()),
                   "large.json: has 1073741825 bytes");
}

} // namespace
