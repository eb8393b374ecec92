// SPDX-License-Identifier: Apache-2.0
#include <raycontact/error.h>
#include <report/report.h>
#include <scenes/models/procedural.h>

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <locale>
#include <unistd.h>

using namespace raycontact;
using namespace raycontact::report;

namespace {

/// Nine gears over a slab.
scenes::RunLog small_log() {
    scenes::RunLog log;
    log.scene = "avalanche";
    log.arguments = "avalanche --bodies 9";
    log.seed = 77;
    log.mesh_source = "a gear <of the test>";
    Mesh slab{"slab", {}, {}};
    for (int i = 0; i < 8; ++i) slab.vertices.push_back({i & 1 ? 9.0 : -9.0, i & 2 ? 9.0 : -9.0, i & 4 ? 0.0 : -1.0});
    slab.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    log.shapes = {Shape::make(scenes::gear(300)), Shape::make(slab)};
    for (int body = 0; body < 10; ++body) {
        log.body_shape.push_back(body == 9);
        log.body_moves.push_back(body != 9);
    }
    for (std::uint32_t step = 0; step < 20; ++step) {
        scenes::StepRow row;
        row.step = step;
        row.pairs = 1234 + step;
        row.details.rays = 56789 + step;
        row.contacts = step < 5 ? 0 : 4321 + step;
        row.step_ms = 12.625;
        row.narrow_ms = 7.375;
        row.details.ray_length = 3.0625;
        row.penetration_max = 0.015625;
        row.median_speed = 2.03125;
        log.rows.push_back(row);
    }
    log.summary_json = R"({"scene": "avalanche", "seed": 77, "steps": 20, "bodies": 9, "rays": 1135970,
        "penetration_max": 0.015625, "step_ms": {"median": 12.625, "p95": 13.5}, "method": "standard", "caster": "bvh",
        "direction": "reprojected", "features": "vertices", "speculative": 0.02, "devices": ["cpu"], "hash": "00ff00ff00ff00ff", "unheard_of": "<b>kept</b>"})";
    return log;
}

std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void write_report(const std::filesystem::path& folder, const scenes::RunLog& log, const Comparison& comparison = {},
                  const std::string& view = {}) {
    output::OutFolder out(folder);
    raycontact::report::write_report(out, log, view, comparison);
    out.keep();
}

class Report : public ::testing::Test {
protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() / ("raycontact-report-test-" + std::to_string(::getpid()));
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::filesystem::path folder_;
};

} // namespace

TEST_F(Report, IsOneFileWithTheNumbersOfTheLog) {
    write_report(folder_ / "deep" / "down", small_log());
    const std::string html = bytes_of(folder_ / "deep" / "down" / "report.html");
    const char* const command =
        "raycontact run avalanche --bodies 9 --steps 20 --seed 77 --method standard "
        "--caster bvh --direction reprojected --features vertices --speculative 0.02 --devices cpu --out "
        "DIR";
    for (const char* text : {"Avalanche: 9 meshes", "a gear &lt;of the test&gt;", "1234", "56789", "4326", "12.625",
                             "7.375", "3.0625", "15.625", "2.03125", "1\u202f135\u202f970", "00ff00ff00ff00ff",
                             "unheard_of", "&lt;b&gt;kept&lt;/b&gt;", command})
        EXPECT_NE(html.find(text), std::string::npos) << text;
    // Nothing may come from elsewhere: no address at all, and every source is inline.
    for (const char* text : {"http:", "https:", "//www", "@import", "url(", "<b>kept"})
        EXPECT_EQ(html.find(text), std::string::npos) << text;
    for (const std::string attribute : {" src=\"", " href=\""})
        for (std::size_t at = 0; (at = html.find(attribute, at)) != std::string::npos; ++at)
            EXPECT_EQ(html.substr(at + attribute.size(), 5), "data:");
}

/// What a host program may set for all streams.
struct Grouped : std::numpunct<char> {
    char do_thousands_sep() const override { return '.'; }
    char do_decimal_point() const override { return ','; }
    std::string do_grouping() const override { return "\3"; }
};

TEST_F(Report, DoesNotFollowTheHostsLocale) {
    scenes::RunLog log = small_log();
    write_report(folder_ / "classic", log);
    const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Grouped));
    write_report(folder_ / "grouped", log);
    std::locale::global(before);
    EXPECT_EQ(bytes_of(folder_ / "grouped" / "report.html"), bytes_of(folder_ / "classic" / "report.html"));
}

TEST_F(Report, ACutRunSaysSo) {
    scenes::RunLog log = small_log();
    log.summary_json = R"({"bodies": 9, "steps": 20, "steps_planned": 600, "cut_short": true})";
    write_report(folder_, log);
    const std::string html = bytes_of(folder_ / "report.html");
    EXPECT_NE(html.find("(cut short)"), std::string::npos);
    EXPECT_NE(html.find("Cut short: 20 of 600 steps were done."), std::string::npos);
    EXPECT_EQ(html.find("steps_planned"), std::string::npos);
}

TEST_F(Report, TheViewIsAFrameOfItsOwn) {
    write_report(folder_ / "with", small_log(), {}, "<p title=\"a & b\">'seen'</p>");
    EXPECT_NE(bytes_of(folder_ / "with" / "report.html")
                  .find("srcdoc=\"&lt;p title=&quot;a &amp; b&quot;&gt;&#39;seen&#39;&lt;/p&gt;\""),
              std::string::npos);
    write_report(folder_ / "without", small_log());
    EXPECT_EQ(bytes_of(folder_ / "without" / "report.html").find("<iframe"), std::string::npos);
}

TEST_F(Report, SaysNothingTwiceAndNoZeros) {
    scenes::RunLog log = small_log();
    for (scenes::StepRow& row : log.rows) row.median_speed = 0;
    log.summary_json = R"({"bodies": 9, "walks": 0, "seed": 0, "predictions": 0, "contacts": 12})";
    write_report(folder_, log, {"Beside another", {{"other", "3.5", "s", "slower"}}, "a note"});
    const std::string html = bytes_of(folder_ / "report.html");
    EXPECT_NE(html.find("<b>Pairs</b> <span class=\"unit\"></span>"), std::string::npos);
    EXPECT_EQ(html.find("Median speed"), std::string::npos); // nothing moved
    EXPECT_EQ(html.find("<td>Walks</td>"), std::string::npos);
    EXPECT_NE(html.find("None, or 0: Walks, Predictions."), std::string::npos);
    EXPECT_NE(html.find("<td>Seed</td>"), std::string::npos);
    EXPECT_NE(html.find(">19</text>"), std::string::npos); // the axes end at the last step
    EXPECT_NE(html.find("Beside another"), std::string::npos);
    EXPECT_NE(html.find("<td>other</td><td class=\"value\">3.5</td>"), std::string::npos);
}

TEST_F(Report, AnUnreadableSummaryLeavesTheRestStanding) {
    scenes::RunLog log = small_log();
    log.summary_json = "{\"rays\": ";
    write_report(folder_, log);
    EXPECT_NE(bytes_of(folder_ / "report.html").find("raycontact run avalanche --bodies 9 --seed 77"),
              std::string::npos);
}

TEST_F(Report, AFolderThatCannotBeMadeIsSaid) {
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "file") << "in the way";
    EXPECT_THROW(write_report(folder_ / "file", small_log()), InputError);
}
