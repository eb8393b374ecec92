// SPDX-License-Identifier: Apache-2.0
// `raycontact view` as a user's script meets it.
#include "expect.h"

#include <filesystem>
#include <gtest/gtest.h>

namespace {

class ViewProgram : public testing::Test {
protected:
    ViewProgram() {
        const auto run = run_program(
            {"run", "avalanche", "--bodies", "6", "--steps", "70", "--record", "a.glb", "--json"}, folder_.path());
        EXPECT_EQ(run.status, 0) << run.err;
    }
    ProgramResult view(std::vector<std::string> words) const {
        words.insert(words.begin(), "view");
        return run_program(words, folder_.path());
    }
    TemporaryFolder folder_;
};

TEST_F(ViewProgram, WritesThePageBesideTheRecording) {
    const auto result = view({"a.glb", "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json["file"], "a.html");
    EXPECT_EQ(json["bytes"], std::filesystem::file_size(folder_.path() / "a.html"));
    EXPECT_EQ(json["steps"], 70);
    EXPECT_EQ(json["layers_every"], 2); // about sixty steps
    EXPECT_GT(json["contacts"], 0);
    EXPECT_EQ(json["predictions"], 0);
    EXPECT_LT(json["motion_bytes"].get<std::uint64_t>() + json["layer_bytes"].get<std::uint64_t>(), json["bytes"]);
}

TEST_F(ViewProgram, TakesAnotherMethodAndFile) {
    const auto result =
        view({"a.glb", "--json", "--method", "predictive", "--out", "b.html", "--every", "5", "--layers-every", "10"});
    ASSERT_EQ(result.status, 0) << result.err;
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json["file"], "b.html");
    EXPECT_EQ(json["every"], 5);
    EXPECT_EQ(json["method"], "predictive");
    EXPECT_GT(json["predictions"], 0);
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "a.html"));
}

TEST_F(ViewProgram, SaysWhatToOpenWithoutADesktop) {
    const auto result = view({"a.glb", "--no-open", "--layers-every", "0"});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("a.html: "), std::string::npos) << result.out;
}

TEST_F(ViewProgram, RefusesWhatItCannotDo) {
    folder_.write("no.glb", "this is no recording");
    expect_refused(view({"missing.glb"}), "missing.glb");
    expect_refused(view({"no.glb"}), "no.glb");
    expect_refused(view({"a.glb", "--out", "no.glb/b.html"}), "no.glb/b.html");
    expect_refused(view({"a.glb", "--out", "a.glb"}), "a.glb is the recording itself");
    expect_refused(view({"a.glb", "--every", "0"}), "--every");
    expect_refused(view({"a.glb", "--method", "sometimes"}), "sometimes");
    EXPECT_EQ(run_program({"replay", "a.glb", "--json"}, folder_.path()).status, 0); // and leaves the recording whole
}

} // namespace
