// SPDX-License-Identifier: Apache-2.0
// A replay does the run's work again: the same contacts, to the bit, for every caster and thread count.
#include "sample.h"

#include <recording/replay.h>
#include <scenes/avalanche.h>

#include <gtest/gtest.h>

using namespace raycontact;
using namespace raycontact::recording;

namespace {

/// Records 27 gears falling for a second; returns the run's hash.
std::string record_avalanche(const std::filesystem::path& file, std::uint64_t& contacts, std::uint64_t& rays) {
    scenes::AvalancheOptions options;
    options.bodies = 27;
    options.model = "gear";
    options.triangles = 240;
    options.expected_steps = 60;
    scenes::Avalanche scene(options);
    Info info;
    info.scene = "avalanche";
    info.seed = options.seed;
    info.bodies = 27;
    Writer writer(file, info);
    for (const auto& shape : scene.log().shapes) writer.add_shape(*shape);
    for (const std::uint32_t shape : scene.log().body_shape) writer.add_body(shape);
    for (int i = 0; i < 60; ++i) {
        scene.step();
        writer.step(scene.scene());
    }
    writer.finish(scene.hash());
    contacts = scene.contacts_total();
    rays = scene.rays_total();
    return scene.hash();
}

Contact contact(std::uint32_t a, std::uint32_t vertex, std::uint32_t triangle) {
    Contact c;
    c.body_a = a;
    c.body_b = 9;
    c.vertex = vertex;
    c.triangle = triangle;
    return c;
}

} // namespace

TEST(Replay, ReproducesTheRun) {
    const TemporaryFile file;
    std::uint64_t contacts = 0, rays = 0;
    const std::string hash = record_avalanche(file.path(), contacts, rays);
    EXPECT_GT(contacts, 1000u);
    for (const Caster caster : {Caster::bvh, Caster::basic}) {
        for (const std::uint32_t threads : {1u, 2u}) {
            Reader reader(file.path());
            EXPECT_EQ(reader.hash(), hash);
            ReplayOptions options;
            options.settings.caster = caster;
            options.settings.threads = threads;
            options.compare = threads == 2;
            const raycontact::recording::Replay result = replay(reader, options);
            EXPECT_EQ(result.hash, hash) << to_string(caster) << ", " << threads;
            EXPECT_EQ(result.contacts, contacts);
            EXPECT_EQ(result.rays, rays);
            EXPECT_EQ(result.steps.size(), 60u);
            ASSERT_EQ(result.wrong_rays.has_value(), options.compare);
            if (!options.compare) continue;
            EXPECT_EQ(result.wrong_rays->total(), 0u);
            EXPECT_EQ(result.wrong_rays->rays_compared, rays);
            EXPECT_EQ(result.wrong_rays->contacts_compared, contacts);
        }
    }
}

TEST(Replay, AnotherDirectionIsAnotherHash) {
    const TemporaryFile file;
    std::uint64_t contacts = 0, rays = 0;
    const std::string hash = record_avalanche(file.path(), contacts, rays);
    Reader reader(file.path());
    ReplayOptions options;
    options.settings.direction = Direction::ray;
    EXPECT_NE(replay(reader, options).hash, hash);
}

TEST(Replay, BodiesComeAndGo) {
    const Sample sample = make_sample(30);
    const TemporaryFile file;
    record(sample, file.path(), true);
    // The same by hand.
    Scene scene(sample.info.settings);
    ContactHash hash;
    for (std::uint32_t i = 0; i < 30; ++i) {
        for (BodyId id = 0; id < sample.bodies.size(); ++id) {
            const Body& body = sample.bodies[id];
            if (body.first_step == i) scene.add(sample.shapes[body.shape], sample.poses[i][id]);
            if (body.end_step == i) scene.remove(id);
            if (body.alive(i)) scene.set_pose(id, sample.poses[i][id]);
        }
        hash.add(i, scene.step(sample.pairs[i]));
    }
    Reader reader(file.path());
    ReplayOptions options;
    options.settings = reader.info().settings;
    EXPECT_EQ(replay(reader, options).hash, hash.hex());
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
    wrong.add({}, reference);
    EXPECT_EQ(wrong.missed, 5u);
    wrong.add(reference, {});
    EXPECT_EQ(wrong.invented, 7u);
}
