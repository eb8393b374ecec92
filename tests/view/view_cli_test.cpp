// SPDX-License-Identifier: Apache-2.0
// `raycontact view` as a user's script meets it.
#include "expect.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

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
    std::string text_of(const char* name) const {
        std::ifstream file(folder_.path() / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
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

TEST_F(ViewProgram, ShowsWhatClashWrote) {
    for (const auto& [name, x] : {std::pair("a.obj", 5e6), {"b.obj", 5e6 + 1.75}, {"c.obj", 5e6 + 9}}) {
        std::string text;
        for (int i = 0; i < 8; ++i)
            text += fmt::format("v {} {} {}\n", x + (i & 1 ? 1 : -1), i & 2 ? 1 : -1, i & 4 ? 1 : -1);
        folder_.write(name, text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
    }
    ASSERT_EQ(run_program({"clash", "a.obj", "b.obj", "c.obj", "--out", "red.glb"}, folder_.path()).status, 0);
    const auto result = view({"red.glb", "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json["file"], "red.html");
    EXPECT_EQ(json["bodies"], 3);
    EXPECT_EQ(json["clashes"], 1);
    const std::string html = text_of("red.html"), start = "id=\"recording\">";
    const std::size_t from = html.find(start) + start.size();
    const auto page = nlohmann::json::parse(html.substr(from, html.find("</script>", from) - from));
    const auto& clash = page["clashes"][0];
    EXPECT_EQ(clash["name"], "a.obj x b.obj");
    EXPECT_EQ(clash["kind"], "overlapping");
    EXPECT_EQ(std::pair(clash["a"], clash["b"]), std::pair(nlohmann::json(0), nlohmann::json(1)));
    EXPECT_NEAR(clash["depth"].get<double>(), 0.25, 1e-6);
    EXPECT_NEAR(clash["at"][0].get<double>(), 5e6 + 0.875, 0.126) << "of the file";
    EXPECT_NEAR(clash["point"][0].get<double>(), 0.875 - 4.5, 0.126) << "of the page, about the middle";
    EXPECT_EQ(page["bodies"][0][3], page["bodies"][1][3]);
    EXPECT_NE(page["bodies"][0][3], page["bodies"][2][3]);

    // What another program changed is no longer it.
    std::string bytes = text_of("red.glb");
    bytes.replace(bytes.find("\"kind\""), 6, "\"King\"");
    folder_.write("red.glb", bytes);
    expect_refused(view({"red.glb"}), "red.glb: is not as raycontact clash wrote it");
    folder_.write("red.glb", bytes.substr(0, bytes.size() / 2));
    expect_refused(view({"red.glb"}), "red.glb");
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
