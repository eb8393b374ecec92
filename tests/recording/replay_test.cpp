// SPDX-License-Identifier: Apache-2.0
// A replay does the run's work again: the same contacts, to the bit, for every caster and thread count.
#include "sample.h"

#include <recording/replay.h>
#include <scenes/avalanche.h>
#include <scenes/models/model.h>
#include <scenes/simulation.h>

#include <raycontact/error.h>

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <utility>

using namespace raycontact;
using namespace raycontact::recording;

namespace {

/// What a run found.
struct Found {
    std::string hash;
    std::uint64_t contacts = 0, rays = 0;
};

/// Records 27 gears falling for a second.
Found record_avalanche(const std::filesystem::path& file, const Settings& settings = {}) {
    scenes::SceneOptions options;
    options.bodies = 27;
    options.model = "gear";
    options.triangles = 240;
    options.steps = 60;
    options.settings = settings;
    scenes::Simulation scene(scenes::avalanche(options));
    Info info;
    info.scene = "avalanche";
    info.seed = options.seed;
    info.bodies = 27;
    info.settings = settings;
    Writer writer(file, info);
    for (const auto& shape : scene.log().shapes) writer.add_shape(*shape);
    for (const std::uint32_t shape : scene.log().body_shape) writer.add_body(shape);
    std::uint64_t contacts = 0, rays = 0;
    for (int i = 0; i < 60; ++i) {
        scene.step();
        writer.step(scene.scene());
        contacts += scene.stats().contacts;
        rays += scene.stats().details.rays;
    }
    writer.finish(scene.hash());
    return {scene.hash(), contacts, rays};
}

Settings settings_of(Method method) {
    Settings settings;
    settings.method = method;
    return settings;
}

Contact contact(std::uint32_t a, std::uint32_t vertex, std::uint32_t triangle) {
    Contact c;
    c.body_a = {a};
    c.body_b = {9};
    c.feature.index_a = vertex;
    c.feature.index_b = triangle;
    return c;
}

} // namespace

class ReplayOf : public testing::TestWithParam<Method> {};

// Methods that keep something from step to step keep the same again: poses and pairs are the run's, from the first on.
TEST_P(ReplayOf, ReproducesTheRun) {
    const TemporaryFile file;
    Settings settings = settings_of(GetParam());
    for (const std::optional<double> threshold : {std::optional<double>(), std::optional(0.004)}) {
        settings.paper.displacement_threshold = threshold;
        const Found run = record_avalanche(file.path(), settings);
        EXPECT_GT(run.contacts, 600u);
        for (const Caster caster : {Caster::bvh, Caster::basic}) {
            for (const std::uint32_t threads : {1u, 2u}) {
                Reader reader(file.path());
                EXPECT_EQ(reader.hash(), run.hash);
                ReplayOptions options;
                options.settings = reader.info().settings;
                EXPECT_TRUE(must_agree(reader.info().settings, options.settings));
                options.settings.paper.caster = caster;
                options.settings.execution.threads = threads;
                const raycontact::recording::Replay result = replay(reader, options);
                EXPECT_EQ(result.hash, run.hash) << to_string(caster) << ", " << threads;
                EXPECT_EQ(result.contacts, run.contacts);
                EXPECT_EQ(result.steps.size(), 60u);
                EXPECT_FALSE(result.wrong_rays.has_value());
                if (caster == settings.paper.caster) {
                    EXPECT_EQ(result.rays, run.rays);
                }
            }
        }
    }
}

// Whatever the method, a comparison is with every ray cast in full.
TEST_P(ReplayOf, IsComparedWithStandard) {
    const TemporaryFile file;
    const Found run = record_avalanche(file.path(), settings_of(GetParam()));
    Reader reader(file.path());
    ReplayOptions options;
    options.settings = reader.info().settings;
    options.compare = true;
    const raycontact::recording::Replay compared = replay(reader, options);
    EXPECT_EQ(compared.hash, run.hash);
    options.settings.method = Method::standard;
    options.compare = false;
    const raycontact::recording::Replay standard = replay(reader, options);
    ASSERT_TRUE(compared.wrong_rays.has_value());
    const WrongRays& wrong = *compared.wrong_rays;
    EXPECT_EQ(wrong.rays_compared, standard.rays);
    EXPECT_EQ(wrong.contacts_compared, standard.contacts);
    EXPECT_EQ(compared.contacts + wrong.missed, standard.contacts + wrong.invented);
    EXPECT_EQ(wrong.total() == 0, compared.hash == standard.hash);
    if (GetParam() == Method::certified || GetParam() == Method::standard) {
        EXPECT_EQ(wrong.total(), 0u);
    }
    WrongRays sum;
    for (std::size_t i = 0; i < compared.steps.size(); ++i) {
        sum.add(compared.steps[i].wrong);
        EXPECT_EQ(compared.steps[i].wrong.rays_compared, standard.steps[i].details.rays);
        EXPECT_EQ(compared.steps[i].pairs, standard.steps[i].pairs);
    }
    EXPECT_EQ(sum.total(), wrong.total());
    EXPECT_EQ(sum.missed, wrong.missed);
    EXPECT_EQ(sum.invented, wrong.invented);
    EXPECT_EQ(sum.rays_compared, wrong.rays_compared);
    EXPECT_EQ(sum.contacts_compared, wrong.contacts_compared);
}

INSTANTIATE_TEST_SUITE_P(Methods, ReplayOf,
                         testing::Values(Method::standard, Method::iterative, Method::predictive, Method::certified),
                         [](const auto& test) { return std::string(to_string(test.param)); });

TEST(Replay, StandardAndCertifiedReproduceEachOther) {
    for (const auto& [recorded, used] :
         {std::pair{Method::standard, Method::certified}, std::pair{Method::certified, Method::standard}}) {
        const TemporaryFile file;
        const Found run = record_avalanche(file.path(), settings_of(recorded));
        Reader reader(file.path());
        ReplayOptions options;
        options.settings = settings_of(used);
        options.settings.paper.displacement_threshold = 0.01;
        EXPECT_TRUE(must_agree(reader.info().settings, options.settings));
        EXPECT_EQ(replay(reader, options).hash, run.hash);
    }
}

TEST(Replay, WhatMustAgree) {
    for (const Method method : {Method::standard, Method::iterative, Method::predictive, Method::certified}) {
        const bool exact = method == Method::standard || method == Method::certified;
        const Settings recorded = settings_of(method);
        const auto agrees = [&](auto member, auto value) {
            Settings used = recorded;
            used.*member = value;
            return must_agree(recorded, used);
        };
        const auto of_paper = [&](auto member, auto value) {
            Settings used = recorded;
            used.paper.*member = value;
            return must_agree(recorded, used);
        };
        EXPECT_TRUE(must_agree(recorded, recorded));
        EXPECT_TRUE(of_paper(&PaperOptions::caster, Caster::basic));
        EXPECT_TRUE(agrees(&Settings::execution, Execution{.threads = 3}));
        EXPECT_FALSE(agrees(&Settings::direction, Direction::ray));
        EXPECT_FALSE(agrees(&Settings::direction, Direction::weighted));
        EXPECT_FALSE(agrees(&Settings::features, Features::vertices));
        EXPECT_FALSE(agrees(&Settings::max_contacts_per_pair, 4u));
        EXPECT_FALSE(agrees(&Settings::max_contacts, 4u));
        EXPECT_EQ(of_paper(&PaperOptions::displacement_threshold, 0.01), exact);
        EXPECT_EQ(of_paper(&PaperOptions::confidence, 3.0), exact);
        EXPECT_EQ(of_paper(&PaperOptions::culling_distance, 0.01), exact);
        EXPECT_EQ(of_paper(&PaperOptions::distance_extension, 0.01), exact);
        EXPECT_EQ(of_paper(&PaperOptions::max_iterations, 3u), exact);
        EXPECT_EQ(of_paper(&PaperOptions::cast_lost_walks, false), exact);
        EXPECT_EQ(of_paper(&PaperOptions::skip_outside, false), exact);
        EXPECT_EQ(agrees(&Settings::method, Method::standard), exact);
        EXPECT_EQ(agrees(&Settings::method, Method::certified), exact);
        EXPECT_EQ(agrees(&Settings::method, Method::iterative), method == Method::iterative);
        EXPECT_EQ(agrees(&Settings::method, Method::predictive), method == Method::predictive);
    }
}

TEST(Replay, AnotherDirectionIsAnotherHash) {
    const TemporaryFile file;
    const Found run = record_avalanche(file.path());
    Reader reader(file.path());
    ReplayOptions options;
    options.settings.direction = Direction::ray;
    EXPECT_NE(replay(reader, options).hash, run.hash);
}

TEST(Replay, ARunWithEdgesIsReproduced) {
    for (const Method method : {Method::standard, Method::iterative, Method::predictive, Method::certified}) {
        const TemporaryFile file;
        Settings settings = settings_of(method);
        settings.features = Features::edges;
        const Found run = record_avalanche(file.path(), settings);
        Reader reader(file.path());
        ReplayOptions options;
        options.settings = reader.info().settings;
        EXPECT_EQ(options.settings.features, Features::edges);
        for (const std::uint32_t threads : {1u, 2u}) {
            options.settings.execution.threads = threads;
            const raycontact::recording::Replay again = replay(reader, options);
            EXPECT_EQ(again.hash, run.hash) << to_string(method);
            EXPECT_EQ(again.contacts, run.contacts);
        }
        options.settings.features = Features::vertices;
        EXPECT_LT(replay(reader, options).contacts, run.contacts);
    }
}

TEST(Replay, AWeightedRunIsReproduced) {
    for (const Method method : {Method::certified, Method::predictive}) {
        const TemporaryFile file;
        Settings settings = settings_of(method);
        settings.direction = Direction::weighted;
        const Found run = record_avalanche(file.path(), settings);
        Reader reader(file.path());
        ReplayOptions options;
        options.settings = reader.info().settings;
        EXPECT_EQ(options.settings.direction, Direction::weighted);
        EXPECT_EQ(replay(reader, options).hash, run.hash);
        options.settings.direction = Direction::ray; // of vertices and edges in place of faces
        EXPECT_NE(replay(reader, options).hash, run.hash);
    }
}

TEST(Replay, BodiesComeAndGo) {
    const Sample sample = make_sample(30);
    const TemporaryFile file;
    record(sample, file.path(), true);
    // The same by hand.
    Scene scene(sample.info.settings);
    ContactHash hash;
    for (std::uint32_t i = 0; i < 30; ++i) {
        for (std::uint32_t id = 0; id < sample.bodies.size(); ++id) {
            const Body& body = sample.bodies[id];
            if (body.first_step == i) scene.add(sample.shapes[body.shape], sample.poses[i][id]);
            if (body.end_step == i) scene.remove({id});
            if (body.alive(i)) scene.set_pose({id}, sample.poses[i][id]);
        }
        hash.add(i, scene.find_contacts(sample.pairs[i]));
    }
    Reader reader(file.path());
    ReplayOptions options;
    options.settings = reader.info().settings;
    EXPECT_EQ(replay(reader, options).hash, hash.hex());
}

// Bodies come, go, and come into slots of others, some between two steps; the writer knows their ids.
TEST(Replay, SlotsAreThoseOfTheRun) {
    const std::vector<std::shared_ptr<const Shape>> shapes{Shape::make(scenes::scene_model("knot", 60).mesh),
                                                           Shape::make(scenes::scene_model("torus", 60).mesh)};
    for (const Method method : {Method::standard, Method::iterative, Method::predictive, Method::certified}) {
        std::mt19937 random(9);
        const auto below = [&](std::size_t n) { return static_cast<std::uint32_t>(random() % n); };
        const auto somewhere = [&] {
            const auto number = [&] { return 0.01 * (double(below(100)) - 50); };
            return pose_from_quaternion({number(), number(), number()}, 1, number(), number(), number());
        };
        const TemporaryFile file;
        Info info;
        info.settings = settings_of(method);
        Scene scene(info.settings);
        Writer writer(file.path(), info);
        for (const auto& shape : shapes) writer.add_shape(*shape);
        ContactHash hash;
        std::vector<BodyId> live;
        std::vector<std::vector<Pair>> pairs;
        std::uint32_t last_generation = 0;
        std::uint64_t contacts = 0;
        for (std::uint32_t i = 0; i < 120; ++i) {
            for (std::uint32_t events = below(5); events > 0 || live.size() < 4;) {
                if (events > 0) --events;
                if (live.size() < 4 || (live.size() < 10 && below(2))) {
                    const std::uint32_t shape = below(2);
                    live.push_back(scene.add(shapes[shape], somewhere()));
                    ASSERT_EQ(writer.add_body(shape), live.back());
                    last_generation = std::max(last_generation, live.back().generation);
                } else {
                    std::swap(live[below(live.size())], live.back());
                    scene.remove(live.back());
                    writer.remove_body(live.back());
                    EXPECT_THROW(writer.remove_body(live.back()), InputError);
                    live.pop_back();
                }
            }
            for (const BodyId id : live) {
                if (below(3) == 0) scene.set_pose({id}, somewhere());
            }
            hash.add(i, scene.find_contacts());
            contacts += scene.contacts().size();
            writer.step(scene);
            pairs.emplace_back(scene.pairs().begin(), scene.pairs().end());
        }
        writer.finish(hash.hex());
        EXPECT_GT(last_generation, 3u);
        EXPECT_GT(contacts, 1000u);

        Reader reader(file.path());
        EXPECT_EQ(reader.version(), 2u);
        std::vector<Pose> poses;
        std::vector<Pair> read;
        for (std::uint32_t i = 0; i < reader.steps(); ++i) {
            reader.read_step(i, poses, read);
            ASSERT_EQ(read, pairs[i]);
        }
        for (const BodyId id : live) EXPECT_EQ(poses[id.slot], scene.pose({id}));
        ReplayOptions options;
        options.settings = reader.info().settings;
        EXPECT_EQ(replay(reader, options).hash, hash.hex()) << to_string(method);
    }
}

// In recordings of version 1 the third of these has slot 2, and that is in the hash.
TEST(Replay, OlderRecordingsKeepTheirSlots) {
    const auto shape = Shape::make(scenes::scene_model("sphere", 60).mesh);
    const auto pose = [](double x) { return pose_from_quaternion({x, 0, 0}, 1, 0.1 * x, 0, 0); };
    const TemporaryFile file;
    {
        Writer writer(file.path(), {});
        writer.add_shape(*shape);
        const BodyId first = writer.add_body(0), second = writer.add_body(0);
        const std::vector<Pose> poses{pose(0), pose(0.3)};
        writer.step(poses, std::vector<Pair>{{first, second}});
        writer.remove_body(first);
        writer.step(poses, {});
        const BodyId third = writer.add_body(0);
        EXPECT_EQ(third, (BodyId{0, 1}));
        writer.step(std::vector<Pose>{pose(0.1), pose(0.3)}, std::vector<Pair>{{third, second}});
        writer.finish("0123456789abcdef");
    }
    const auto hash_of = [&](bool older) {
        Scene scene;
        ContactHash hash;
        const BodyId first = scene.add(shape, pose(0)), second = scene.add(shape, pose(0.3));
        hash.add(0, scene.find_contacts(std::vector<Pair>{{first, second}}));
        EXPECT_GT(scene.contacts().size(), 0u);
        if (!older) scene.remove(first);
        hash.add(1, scene.find_contacts(std::span<const Pair>{}));
        const BodyId third = scene.add(shape, pose(0.1));
        EXPECT_EQ(third, older ? BodyId{2} : (BodyId{0, 1}));
        hash.add(2, scene.find_contacts(std::vector<Pair>{{third, second}}));
        EXPECT_GT(scene.contacts().size(), 0u);
        return hash.hex();
    };
    const auto replayed = [&] {
        Reader reader(file.path());
        return replay(reader, {}).hash;
    };
    EXPECT_EQ(replayed(), hash_of(false));

    edit_json(file.path(), BlockType::info, [](nlohmann::ordered_json& info) { info["version"] = 1; });
    EXPECT_THROW(replayed(), InputError) << "a version that was damaged";
    auto bytes = bytes_of(file.path());
    bytes[side_chunk_at(bytes) + 8 + 8] = 1;
    write_bytes(file.path(), bytes);
    EXPECT_EQ(Reader(file.path()).version(), 1u);
    EXPECT_EQ(Reader(file.path()).bodies()[2].id, BodyId{2});
    EXPECT_EQ(replayed(), hash_of(true));
    EXPECT_NE(hash_of(true), hash_of(false));
}

TEST(Replay, WrongRaysAreCounted) {
    const std::vector<Contact> reference{contact(0, 1, 5), contact(0, 2, 6), contact(1, 0, 7), contact(2, 4, 8)};
    const std::vector<Contact> found{contact(0, 0, 1), contact(0, 1, 5), contact(1, 0, 9),
                                     contact(2, 3, 8), contact(2, 4, 8), contact(3, 0, 0)};
    WrongRays wrong;
    wrong.add(found, reference);
    EXPECT_EQ(wrong.missed, 1u);         // (0, 2)
    EXPECT_EQ(wrong.invented, 3u);       // (0, 0), (2, 3), (3, 0)
    EXPECT_EQ(wrong.other_triangle, 1u); // (1, 0)
    EXPECT_EQ(wrong.total(), 5u);
    EXPECT_EQ(wrong.contacts_compared, 4u);
    EXPECT_TRUE(std::isnan(wrong.percent())); // of no rays
    wrong.rays_compared = 40;
    EXPECT_DOUBLE_EQ(wrong.percent(), 12.5);
    wrong.add({}, reference);
    EXPECT_EQ(wrong.missed, 5u);
    wrong.add(reference, {});
    EXPECT_EQ(wrong.invented, 7u);
}
