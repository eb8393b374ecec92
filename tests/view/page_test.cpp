// SPDX-License-Identifier: Apache-2.0
#include "program.h"
#include "reference/meshes.h"

#include <raycontact/error.h>
#include <recording/writer.h>
#include <view/blob.h>
#include <view/view.h>

#include <gtest/gtest.h>

namespace raycontact::view {
namespace {

// Two boxes that overlap for ten steps.
void record(const std::string& file, const std::string& scene, std::uint32_t steps) {
    recording::Info info;
    info.scene = scene;
    info.mesh_source = "boxes </script><!-- of a \"test\"";
    recording::Writer writer(file, info);
    writer.add_shape(*Shape::make(reference::box_mesh({0.5, 0.5, 0.5})));
    const BodyId a = writer.add_body(0), b = writer.add_body(0);
    for (std::uint32_t i = 0; i < steps; ++i) {
        std::vector<Pose> poses(2);
        poses[1].translation = {0.2, 0.1, 0.99 - 0.001 * i};
        writer.step(poses, std::vector<Pair>{{a, b}});
    }
    writer.finish("0123456789abcdef");
}

/// A recording of two boxes.
struct Boxes {
    explicit Boxes(std::uint32_t steps = 10) { record(file, "boxes", steps); }
    TemporaryFolder folder;
    std::string file = folder.path() / "a.glb";
};

nlohmann::json data_of(const std::string& html) {
    const std::string start = "id=\"recording\">";
    const std::size_t from = html.find(start) + start.size();
    return nlohmann::json::parse(html.substr(from, html.find("</script>", from) - from));
}

TEST(Page, NeedsNothingElseAndEscapesNames) {
    const TemporaryFolder folder;
    const std::string file = folder.path() / "a.glb", name = "</script><script>alert(1)</script>";
    record(file, name, 10);
    recording::Reader reader(file);
    const std::string html = make_view(reader, {}).html;
    for (const char* outside : {"http://", "https://", "src=", "@import", "alert(1)</script>"})
        EXPECT_EQ(html.find(outside), std::string::npos) << outside;
    EXPECT_NE(html.find("<title>&lt;/script&gt;"), std::string::npos);
    EXPECT_EQ(data_of(html)["scene"], name);
    EXPECT_EQ(data_of(html)["meshSource"], "boxes </script><!-- of a \"test\"");
}

TEST(Page, HasEveryLayerStepAndCount) {
    const Boxes boxes;
    recording::Reader reader(boxes.file);
    ViewOptions options;
    options.layer_every = 4;
    std::uint32_t told = 0;
    options.progress = [&](std::uint32_t done) { told = done; };
    const View view = make_view(reader, options);
    EXPECT_EQ(told, work_of(reader, options));
    const nlohmann::json data = data_of(view.html);
    std::uint64_t contacts = 0;
    std::vector<std::uint32_t> steps;
    for (const auto& layer : data["layers"]["steps"]) {
        steps.push_back(layer["step"]);
        contacts += layer["contacts"].get<std::uint64_t>();
        EXPECT_EQ(layer["contacts"], data["layers"]["contacts"][steps.back()]);
    }
    EXPECT_EQ(steps, (std::vector<std::uint32_t>{0, 4, 8}));
    EXPECT_EQ(contacts, view.contacts);
    EXPECT_GT(contacts, 0u);
    EXPECT_EQ(data["layers"]["pairs"].size(), 10u);
    EXPECT_EQ(data["bodies"].size(), 2u);
}

TEST(Page, BodiesHaveColoursAndTheGroundIsGrey) {
    const Boxes boxes, once(1); // of one step, what stands still cannot be told yet
    recording::Reader reader(boxes.file), one(once.file);
    const View view = make_view(reader, {}), short_view = make_view(one, {});
    const nlohmann::json bodies = data_of(view.html)["bodies"], early = data_of(short_view.html)["bodies"];
    EXPECT_EQ(view.standing, 1u);
    EXPECT_EQ(data_of(view.html)["standing"], 1);
    EXPECT_EQ(short_view.standing, 0u);
    EXPECT_EQ(bodies[0][3], 0xd3d3d3); // it never moves
    EXPECT_NE(early[0][3], 0xd3d3d3);
    EXPECT_NE(bodies[1][3], early[0][3]);
    EXPECT_EQ(bodies[1][3], early[1][3]);
}

TEST(Page, Base64OfTheStandard) { // RFC 4648, section 10
    const auto coded = [](std::string_view text) { return base64(Bytes(text.begin(), text.end())); };
    EXPECT_EQ(coded(""), "");
    EXPECT_EQ(coded("f"), "Zg==");
    EXPECT_EQ(coded("fo"), "Zm8=");
    EXPECT_EQ(coded("foo"), "Zm9v");
    EXPECT_EQ(coded("foobar"), "Zm9vYmFy");
    EXPECT_EQ(coded("\xff\xfe\xfd"), "//79");
}

TEST(Page, HasTheDeepestContactOfEveryStep) {
    const Boxes boxes;
    recording::Reader reader(boxes.file);
    ViewOptions options;
    options.layer_every = 4;
    const nlohmann::json layers = data_of(make_view(reader, options).html)["layers"];
    ASSERT_EQ(layers["depths"].size(), 10u);
    for (std::size_t i = 0; i < 10; ++i) EXPECT_NEAR(layers["depths"][i].get<double>(), 0.01 + 0.001 * double(i), 1e-6);
    EXPECT_LT(layers["depth"], layers["depths"][9]); // which has no layers
}

TEST(Page, WithoutLayersOrSteps) {
    const TemporaryFolder folder;
    const std::string file = folder.path() / "a.glb", empty = folder.path() / "b.glb";
    record(file, "boxes", 3);
    record(empty, "nothing", 0);
    recording::Reader reader(file), empty_reader(empty);
    ViewOptions options;
    options.layer_every = 0;
    EXPECT_TRUE(data_of(make_view(reader, options).html)["layers"].is_null());
    EXPECT_THROW(static_cast<void>(make_view(empty_reader, options)), InputError);
}

} // namespace
} // namespace raycontact::view
