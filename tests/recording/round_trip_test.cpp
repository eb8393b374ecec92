// SPDX-License-Identifier: Apache-2.0
// What is written is read again, to the bit: whole, in any order, while it is written, without its end.
#include "sample.h"

#include <raycontact/error.h>
#include <scenes/models/model.h>

#include <gtest/gtest.h>

#include <numeric>
#include <optional>
#include <random>

using namespace raycontact;
using namespace raycontact::recording;

TEST(RoundTrip, KeepsEveryBit) {
    const Sample sample = make_sample(47);
    const TemporaryFile file;
    record(sample, file.path(), true);
    Reader reader(file.path());
    EXPECT_EQ(difference(sample, reader, 47), "");
    EXPECT_EQ(reader.hash(), sample.hash);
    EXPECT_FALSE(std::filesystem::exists(file.path().string() + ".last.part"));
}

// Of x.glb and of an x.glb.part that becomes it the last draft has the same name, which a folder takes here.
TEST(RoundTrip, TheLastDraftHasOneName) {
    const Sample sample = make_sample(3);
    for (const char* ending : {"", ".part"}) {
        const TemporaryFile file;
        const std::filesystem::path named = file.path().string() + ending, draft = file.path().string() + ".last.part";
        std::filesystem::create_directory(draft);
        try {
            record(sample, named, true);
            ADD_FAILURE() << "the folder is in the way";
        } catch (const InputError& error) {
            EXPECT_TRUE(std::string(error.what()).starts_with(draft.string() + ": ")) << error.what();
        }
        std::filesystem::remove(draft);
        std::filesystem::remove(named);
    }
}

TEST(RoundTrip, WithoutAnEndThereIsNoHash) {
    const Sample sample = make_sample(18);
    const TemporaryFile file;
    record(sample, file.path(), false);
    Reader reader(file.path());
    EXPECT_EQ(difference(sample, reader, 18), "");
    EXPECT_FALSE(reader.hash().has_value());
}

TEST(RoundTrip, BlocksMayHaveAnyLength) {
    const Sample sample = make_sample(23);
    for (const std::uint32_t flush_steps : {1u, 2u, 22u, 23u, 100u}) {
        const TemporaryFile file;
        record(sample, file.path(), true, {flush_steps, 1e9, 1u << 20});
        Reader reader(file.path());
        EXPECT_EQ(difference(sample, reader, 23), "") << flush_steps;
    }
}

TEST(RoundTrip, StepsMayBeReadInAnyOrder) {
    const Sample sample = make_sample(40);
    const TemporaryFile file;
    record(sample, file.path(), true);
    Reader reader(file.path());
    std::vector<std::uint32_t> order(40);
    std::iota(order.begin(), order.end(), 0u);
    std::shuffle(order.begin(), order.end(), std::mt19937(3));
    std::vector<Pose> poses;
    std::vector<Pair> pairs;
    for (const std::uint32_t i : order) {
        reader.read_step(i, poses, pairs);
        EXPECT_EQ(pairs, sample.pairs[i]);
        for (std::uint32_t id = 0; id < sample.bodies.size(); ++id) {
            if (sample.bodies[id].alive(i)) {
                EXPECT_EQ(poses[id], sample.poses[i][id]) << i;
            }
        }
    }
    EXPECT_THROW(reader.read_step(40, poses, pairs), InputError);
}

TEST(RoundTrip, CanBeReadWhileItIsWritten) {
    const Sample sample = make_sample(33);
    const TemporaryFile file;
    Writer writer(file.path(), sample.info, {4, 1e9, 1u << 20});
    Feeder feeder(sample, writer);
    for (std::uint32_t done = 1; done <= 33; ++done) {
        feeder.step();
        Reader reader(file.path());
        // The first step is written at once, then every fourth.
        const std::uint32_t flushed = 1 + (done - 1) / 4 * 4;
        EXPECT_EQ(difference(sample, reader, flushed), "") << done;
        EXPECT_FALSE(reader.hash().has_value());
    }
    Reader before_the_end(file.path());
    writer.finish(sample.hash);
    EXPECT_EQ(difference(sample, before_the_end, 33), ""); // the file it has open is whole still
    Reader after(file.path());
    EXPECT_EQ(difference(sample, after, 33), "");
    EXPECT_EQ(after.hash(), sample.hash);
}

TEST(RoundTrip, ShapesOfAllKindsAreMadeAgain) {
    std::mt19937_64 numbers(11);
    const auto uniform = [&] { return static_cast<double>(numbers() >> 11) * 0x1p-53 * 2 - 1; };
    const TemporaryFile file;
    std::vector<std::shared_ptr<const Shape>> shapes;
    for (int i = 0; i < 60; ++i) {
        Mesh mesh = scenes::scene_model(i % 2 == 0 ? "sphere" : "torus", 24).mesh;
        const double size = i % 3 == 0 ? 1 : 1e-3 + 10 * (uniform() + 1), away = i % 4 == 0 ? 0 : i % 4 == 1 ? 1e6 : 1;
        const Vec3 offset{away * uniform(), away * uniform(), away * uniform()};
        for (Vec3& v : mesh.vertices)
            v = {size * v.x + offset.x + 1e-3 * size * uniform(), size * v.y + offset.y, size * v.z + offset.z};
        shapes.push_back(Shape::make(mesh));
    }
    {
        Writer writer(file.path(), {});
        for (const auto& shape : shapes) writer.add_shape(*shape);
        writer.finish("0000000000000000");
    }
    const Reader reader(file.path());
    ASSERT_EQ(reader.shapes().size(), shapes.size());
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        EXPECT_EQ(reader.shapes()[i]->centre(), shapes[i]->centre());
        ASSERT_EQ(reader.shapes()[i]->vertices().size(), shapes[i]->vertices().size());
        for (std::size_t v = 0; v < shapes[i]->vertices().size(); ++v)
            EXPECT_EQ(reader.shapes()[i]->vertices()[v], shapes[i]->vertices()[v]);
    }
}

TEST(RoundTrip, EveryMethodAndThresholdIsKept) {
    Sample sample = make_sample(2);
    for (const Method method : {Method::standard, Method::iterative, Method::predictive, Method::certified}) {
        for (const std::optional<double> length :
             {std::optional<double>(), std::optional(0.0), std::optional(1e-300)}) {
            sample.info.settings = {};
            sample.info.settings.method = method;
            sample.info.settings.paper.displacement_threshold = length;
            sample.info.settings.paper.culling_distance = length;
            sample.info.settings.paper.distance_extension = length;
            const TemporaryFile file;
            record(sample, file.path(), true);
            Reader reader(file.path());
            EXPECT_EQ(difference(sample, reader, 2), "") << to_string(method);
        }
    }
}

TEST(RoundTrip, OldRecordingsHaveDefaults) {
    Sample sample = make_sample(5);
    const TemporaryFile file;
    record(sample, file.path(), true);
    edit_json(file.path(), BlockType::info, [](nlohmann::ordered_json& info) {
        for (const char* key :
             {"displacement_threshold", "confidence", "culling_distance", "distance_extension", "max_iterations",
              "cast_lost_walks", "skip_outside", "max_contacts_per_pair", "max_contacts"})
            EXPECT_EQ(info.erase(key), 1u) << key;
        info["method"] = "standard";
    });
    Reader reader(file.path());
    Settings& old = sample.info.settings;
    const Settings fresh;
    old.method = Method::standard;
    old.paper.displacement_threshold = fresh.paper.displacement_threshold;
    old.paper.confidence = fresh.paper.confidence;
    old.paper.distance_extension = fresh.paper.distance_extension;
    old.paper.max_iterations = fresh.paper.max_iterations;
    old.paper.cast_lost_walks = fresh.paper.cast_lost_walks;
    old.paper.skip_outside = fresh.paper.skip_outside;
    old.max_contacts_per_pair = fresh.max_contacts_per_pair;
    old.max_contacts = fresh.max_contacts;
    EXPECT_EQ(difference(sample, reader, 5), "");
    EXPECT_EQ(reader.hash(), sample.hash);
}

TEST(RoundTrip, SettingsOfALaterVersionAreNoDamage) {
    const Sample sample = make_sample(2);
    const auto message_for = [&](const char* key, const nlohmann::ordered_json& value) {
        const TemporaryFile file;
        record(sample, file.path(), true);
        edit_json(file.path(), BlockType::info, [&](nlohmann::ordered_json& info) { info[key] = value; });
        try {
            const Reader reader(file.path());
            return std::string("accepted");
        } catch (const InputError& error) {
            std::string text = error.what();
            EXPECT_TRUE(text.starts_with(file.path().string() + ": ")) << text;
            EXPECT_EQ(text.find('\n'), std::string::npos) << text;
            return text;
        }
    };
    for (const char* key : {"method", "caster", "direction"}) {
        const std::string text = message_for(key, "wavelet");
        EXPECT_NE(text.find("wavelet"), std::string::npos) << text;
        EXPECT_NE(text.find(key), std::string::npos) << text;
        EXPECT_NE(text.find("does not know"), std::string::npos) << text;
        EXPECT_EQ(text.find("damaged"), std::string::npos) << text;
    }
    EXPECT_NE(message_for("method", 7).find("damaged"), std::string::npos);
    EXPECT_NE(message_for("confidence", 0.5).find("confidence"), std::string::npos);
    EXPECT_NE(message_for("confidence", nullptr).find("damaged"), std::string::npos);
    EXPECT_NE(message_for("displacement_threshold", -1).find("displacement_threshold"), std::string::npos);
    EXPECT_NE(message_for("distance_extension", 1e-9).find("distance_extension"), std::string::npos);
    EXPECT_NE(message_for("max_iterations", 0).find("max_iterations"), std::string::npos);
    EXPECT_NE(message_for("cast_lost_walks", "yes").find("damaged"), std::string::npos);
    EXPECT_EQ(message_for("unheard_of", 1), "accepted");
}

TEST(RoundTrip, BadInputIsRefusedInOneLine) {
    const Sample sample = make_sample(2);
    const TemporaryFile file;
    EXPECT_THROW(Writer("/nonexistent/folder/x.glb", {}), InputError);
    EXPECT_THROW(Writer(std::filesystem::temp_directory_path(), {}), InputError);
    Info info;
    info.dt = 0;
    EXPECT_THROW(Writer(file.path(), info), InputError);
    info = {};
    info.settings.paper.confidence = 0.5;
    EXPECT_THROW(Writer(file.path(), info), InputError);
    EXPECT_THROW(Reader("/nonexistent/x.glb"), InputError);
    EXPECT_THROW(Reader{std::filesystem::temp_directory_path()}, InputError);

    Writer writer(file.path(), sample.info);
    EXPECT_THROW(writer.add_body(0), InputError);
    const std::uint32_t shape = writer.add_shape(*sample.shapes[0]);
    writer.add_body(shape);
    writer.add_body(shape);
    EXPECT_THROW(writer.remove_body({2}), InputError);
    std::vector<Pose> poses(2);
    const BodyId zero{0}, one{1}, two{2};
    const Pair fine[] = {{one, zero}}, itself[] = {{one, one}}, missing[] = {{zero, two}};
    EXPECT_THROW(writer.step(std::span(poses).first(1), fine), InputError);
    EXPECT_THROW(writer.step(poses, itself), InputError);
    EXPECT_THROW(writer.step(poses, missing), InputError);
    poses[1].rotation[4] = 2;
    EXPECT_THROW(writer.step(poses, fine), InputError);
    poses[1].rotation[4] = 1;
    writer.step(poses, fine);
    EXPECT_THROW(writer.finish("not a hash"), InputError);
    writer.finish(sample.hash);
    EXPECT_THROW(writer.step(poses, fine), InputError);
    Reader reader(file.path());
    EXPECT_EQ(reader.steps(), 1u);
}
