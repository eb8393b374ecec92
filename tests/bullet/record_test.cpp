// SPDX-License-Identifier: Apache-2.0
// A Bullet world, recorded by one line, replayed without Bullet.
#include "test_world.h"

#include <raycontact/error.h>
#include <raycontact/recorder.h>
#include <recording/replay.h>

#include <filesystem>
#include <gtest/gtest.h>
#include <string>

namespace raycontact::test {
namespace {

std::filesystem::path file_of(const char* name) {
    return std::filesystem::temp_directory_path() / ("raycontact-record-test-" + std::string(name) + ".glb");
}

TEST(Record, AWorldReplaysWithTheSameContacts) {
    const auto file = file_of("world");
    TestWorld world;
    btRigidBody& ground = world.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
    btRigidBody& falling = world.add_mesh(table(), 1, at(0, 0, 3));
    btRigidBody& upper = world.add_mesh(table(), 1, at(0.2, 0.1, 4.2));
    for (const btRigidBody* body : {&ground, &falling, &upper}) world.dispatcher.add_body(*body);
    RecorderOptions options;
    options.scene = "tables";
    world.dispatcher.record(file, options);
    ContactHash hash;
    std::uint64_t contacts = 0;
    for (std::uint32_t step = 0; step < 90; ++step) {
        world.steps(1);
        hash.add(step, world.dispatcher.scene().contacts());
        contacts += world.dispatcher.scene().stats().contacts;
    }
    world.dispatcher.finish_recording();
    world.steps(1); // recorded no more
    EXPECT_GT(contacts, 50u);

    recording::Reader reader(file);
    EXPECT_EQ(reader.info().scene, "tables");
    EXPECT_EQ(reader.steps(), 90u);
    EXPECT_EQ(reader.bodies().size(), 3u);
    EXPECT_EQ(reader.hash(), hash.hex());
    EXPECT_EQ(recording::replay(reader, {}).hash, hash.hex());

    // Far above the ground no pair needs the upper table; its fall is recorded all the same.
    std::vector<Pose> poses;
    std::vector<Pair> pairs;
    reader.read_step(0, poses, pairs);
    EXPECT_TRUE(pairs.empty());
    const double before = poses[2].translation.z;
    reader.read_step(10, poses, pairs);
    EXPECT_LT(poses[2].translation.z, before - 0.1);
    for (btRigidBody* body : {&upper, &falling, &ground}) {
        world.dispatcher.remove_body(*body);
        world.remove(*body);
    }
    std::filesystem::remove(file);
}

// A replay finds other contacts to stand for all, since it does not know where bodies were expected; the recording of
// the poses is none the worse.
TEST(Record, AWorldOfFewerContactsIsRecorded) {
    const auto file = file_of("fewer");
    Settings settings;
    settings.max_contacts_per_pair = 4;
    TestWorld world(settings);
    world.add_mesh(Shape::make(box_mesh(8, 8, 1)), 0, at(0, 0, -0.5));
    world.add_mesh(table(), 1, at(0, 0, 0.5));
    world.dispatcher.record(file);
    EXPECT_NO_THROW(world.steps(30));
    world.dispatcher.finish_recording();
    EXPECT_EQ(recording::Reader(file).steps(), 30u);
    std::filesystem::remove(file);
}

TEST(Record, AFileThatIsGoneIsAnErrorOnce) {
    const auto file = file_of("gone");
    TestWorld world;
    world.dispatcher.record(file);
    world.steps(1);
    std::filesystem::remove(file);
    EXPECT_THROW(world.dispatcher.finish_recording(), InputError);
    EXPECT_NO_THROW(world.steps(1)) << "the recording has ended";
    EXPECT_NO_THROW(world.dispatcher.finish_recording());
}

TEST(Record, AFileThatCannotBeMadeIsAnError) {
    TestWorld world;
    EXPECT_THROW(world.dispatcher.record("/nowhere/at/all.glb"), InputError);
    world.dispatcher.finish_recording(); // there is none
}

} // namespace
} // namespace raycontact::test
