// SPDX-License-Identifier: Apache-2.0
#include "decode.h"

#include <raycontact/error.h>
#include <report/render.h>
#include <report/report.h>
#include <scenes/models/procedural.h>

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <iterator>
#include <locale>
#include <unistd.h>

using namespace raycontact;
using namespace raycontact::report;

namespace {

/// Nine gears over a slab, in three frames.
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
    log.slab = 9;
    for (const std::uint32_t step : {0u, 10u, 19u}) {
        scenes::Frame& frame = log.frames.emplace_back();
        frame.step = step;
        for (int body = 0; body < 9; ++body) {
            Pose pose = pose_from_quaternion({}, 1, 0.3 * body, 0.1 * step, 0.2);
            const int column = body % 3, row = body / 3;
            pose.translation = {1.1 * column, 1.1 * row, 3 - 0.12 * step};
            frame.poses.push_back(pose);
        }
        frame.poses.emplace_back();
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

void write_report(const std::filesystem::path& folder, const scenes::RunLog& log, const Comparison& comparison = {}) {
    output::OutFolder out(folder);
    raycontact::report::write_report(out, log, ReportOptions{2, comparison});
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
                             "unheard_of", "&lt;b&gt;kept&lt;/b&gt;", "step 19, 0.3 s", command})
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
    log.frames.resize(1);
    write_report(folder_ / "classic", log);
    const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Grouped));
    write_report(folder_ / "grouped", log);
    std::locale::global(before);
    EXPECT_EQ(bytes_of(folder_ / "grouped" / "report.html"), bytes_of(folder_ / "classic" / "report.html"));
}

TEST_F(Report, ACutRunSaysSo) {
    scenes::RunLog log = small_log();
    log.frames.resize(1);
    log.summary_json = R"({"bodies": 9, "steps": 20, "steps_planned": 600, "cut_short": true})";
    write_report(folder_, log);
    const std::string html = bytes_of(folder_ / "report.html");
    EXPECT_NE(html.find("(cut short)"), std::string::npos);
    EXPECT_NE(html.find("Cut short: 20 of 600 steps were done."), std::string::npos);
    EXPECT_EQ(html.find("steps_planned"), std::string::npos);
}

TEST_F(Report, PicturesDecodeAndShowSomething) {
    write_report(folder_, small_log());
    for (const char* name : {"step-000.png", "step-019.png"}) {
        const Image image = decode(bytes_of(folder_ / "pictures" / name));
        EXPECT_EQ(image.width, 1600u);
        EXPECT_EQ(image.height, 900u);
        EXPECT_GT(contrast(image), 10) << name;
    }
}

TEST_F(Report, TheFilmIsAnAnimationOfAllFrames) {
    scenes::RunLog log = small_log();
    write_report(folder_, log);
    const std::string film = bytes_of(folder_ / "pictures" / "film.webp"), html = bytes_of(folder_ / "report.html");
    ASSERT_GT(film.size(), 1000u);
    EXPECT_EQ(film.substr(0, 4) + film.substr(8, 4), "RIFFWEBP");
    EXPECT_NE(film.find("ANIM"), std::string::npos);
    std::size_t frames = 0;
    for (std::size_t at = 0; (at = film.find("ANMF", at)) != std::string::npos; ++at) ++frames;
    EXPECT_EQ(frames, log.frames.size());
    EXPECT_NE(html.find("data:image/webp;base64," + base64(film)), std::string::npos);
    EXPECT_NE(html.find("prefers-reduced-motion"), std::string::npos);
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

std::string picture_png(const scenes::RunLog& log, std::size_t frame) {
    return encode_png(Renderer(log).render(log.frames[frame], 160, 90));
}

TEST_F(Report, APictureIsTheSameEveryTimeAndFollowsTheBodies) {
    const scenes::RunLog log = small_log();
    const std::string first = picture_png(log, 0);
    EXPECT_EQ(first, picture_png(log, 0));
    EXPECT_NE(first, picture_png(log, 2));
    EXPECT_GT(contrast(decode(first)), 10);
}

/// A pixel's colours, red first.
std::array<int, 3> pixel(const Image& image, std::uint32_t x, std::uint32_t y) {
    const std::size_t at = 3 * (std::size_t{y} * image.width + x);
    return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

TEST_F(Report, WithoutGroundNoneIsDrawn) {
    scenes::RunLog log = small_log();
    const Image over_slab = decode(picture_png(log, 1));
    EXPECT_NE(pixel(over_slab, 80, 88), pixel(over_slab, 80, 1));
    log.slab.reset();
    log.body_shape.pop_back();
    log.body_moves.pop_back();
    for (scenes::Frame& frame : log.frames) frame.poses.pop_back();
    const Image free = decode(picture_png(log, 1));
    for (const std::uint32_t x : {1u, 80u, 158u}) EXPECT_EQ(pixel(free, x, 88), pixel(free, x, 1));
    write_report(folder_, log);
    EXPECT_EQ(bytes_of(folder_ / "report.html").find("ground square"), std::string::npos);
    log.plane = 0;
    write_report(folder_ / "plane", log);
    EXPECT_NE(bytes_of(folder_ / "plane" / "report.html").find("ground square"), std::string::npos);
}

TEST_F(Report, TheSlabEndsWhereItEnds) {
    scenes::RunLog log = small_log();
    const std::string wide = picture_png(log, 1);
    Mesh small{"slab", {}, {}};
    for (const Vec3& v : log.shapes[1]->vertices()) small.vertices.push_back({v.x / 9, v.y / 9, v.z});
    for (const auto& t : log.shapes[1]->triangles()) small.triangles.push_back(t);
    log.shapes[1] = Shape::make(small);
    EXPECT_NE(picture_png(log, 1), wide);
    const Image image = decode(picture_png(log, 1));
    EXPECT_EQ(pixel(image, 1, 88), pixel(image, 1, 1)); // the backdrop, below as above
}

TEST_F(Report, DrawsAsMuchAsItIsAsked) {
    const scenes::RunLog log = small_log();
    std::vector<std::uint32_t> told;
    ReportOptions options;
    options.pictures = 1;
    options.progress = [&](std::uint32_t done) { told.push_back(done); };
    output::OutFolder all(folder_ / "all");
    raycontact::report::write_report(all, log, options);
    EXPECT_EQ(told.size(), 4u); // a picture and three frames of the film
    EXPECT_EQ(told.back(), work_of(log, options));
    options.stop = [&] { return told.size() >= 6; };
    output::OutFolder part(folder_ / "part");
    raycontact::report::write_report(part, log, options);
    EXPECT_EQ(told.size(), 6u); // and the report is written all the same
    part.keep();
    EXPECT_FALSE(std::filesystem::exists(folder_ / "part" / "pictures" / "film.webp"));
    EXPECT_NE(bytes_of(folder_ / "part" / "report.html").find("Drawing was ended"), std::string::npos);
    options.pictures = 0;
    EXPECT_EQ(work_of(log, options), 0u);
    output::OutFolder none(folder_ / "none");
    raycontact::report::write_report(none, log, options);
    EXPECT_EQ(told.size(), 6u);
    none.keep();
    const std::string html = bytes_of(folder_ / "none" / "report.html");
    for (const char* word : {"Pictures:", "<img", "class=\"film\"", "Drawing was ended"})
        EXPECT_EQ(html.find(word), std::string::npos) << word;
}

TEST_F(Report, AnUnreadableSummaryLeavesTheRestStanding) {
    scenes::RunLog log = small_log();
    log.frames.resize(1);
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
