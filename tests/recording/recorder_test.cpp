// SPDX-License-Identifier: Apache-2.0
// A user's own scene, recorded: bodies that come and go in any order, and the hash of its replay.
#include "sample.h"

#include <raycontact/error.h>
#include <raycontact/primitives.h>
#include <raycontact/recorder.h>
#include <recording/replay.h>
#include <scenes/models/procedural.h>

#include <cmath>
#include <deque>
#include <filesystem>
#include <functional>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

constexpr Method methods[] = {Method::standard, Method::iterative, Method::predictive, Method::certified};

Settings settings_of(Method method) {
    Settings settings;
    settings.method = method;
    settings.execution.threads = 1;
    return settings;
}

std::shared_ptr<const Shape> ball() {
    static const auto shape = Shape::make(scenes::round_sphere(136));
    return shape;
}

/// Spheres on a row that overlap, swing, come and go.
class Row {
public:
    explicit Row(Method method) : scene(settings_of(method)) {}

    BodyId add() {
        static const auto capsule = make_capsule(0.2, 0.1);
        const BodyId id = scene.add(added_ % 4 == 3 ? capsule : ball(), place(added_));
        bodies.emplace_back(id, added_++);
        return id;
    }
    void remove(std::size_t i) {
        scene.remove(bodies[i].first);
        bodies.erase(bodies.begin() + static_cast<std::ptrdiff_t>(i));
    }
    void step() {
        ++steps_;
        for (const auto& [id, number] : bodies) scene.set_pose(id, place(number));
        hash.add(steps_ - 1, scene.find_contacts());
    }

    Scene scene;
    ContactHash hash;
    std::deque<std::pair<BodyId, int>> bodies;

private:
    Pose place(int number) const {
        const double a = 0.02 * steps_ * (1 + number % 3);
        Pose pose;
        pose.rotation = {std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a), 0, 0, 0, 1};
        pose.translation = {0.45 * (number % 7), 0.3 * std::sin(a), 0.1 * std::cos(2 * a)};
        return pose;
    }
    int added_ = 0;
    std::uint32_t steps_ = 0;
};

void expect_same_contacts(const TemporaryFile& file, const std::string& hash, Method method, std::uint32_t steps) {
    recording::Reader reader(file.path());
    EXPECT_EQ(reader.steps(), steps);
    ASSERT_TRUE(reader.hash());
    EXPECT_EQ(*reader.hash(), hash);
    recording::ReplayOptions options;
    options.settings = settings_of(method);
    const recording::Replay replay = recording::replay(reader, options);
    EXPECT_EQ(replay.hash, hash);
    EXPECT_GT(replay.contacts, 0u);
}

class RecorderOf : public testing::TestWithParam<Method> {};

TEST_P(RecorderOf, BodiesThatComeAndGoReplayWithTheSameHash) {
    const TemporaryFile file;
    Row row(GetParam());
    Recorder recorder(file.path(), row.scene, {"row", 0.01, 7, "spheres", {}});
    for (int i = 0; i < 6; ++i) row.add();
    for (int step = 0; step < 40; ++step) {
        if (step % 5 == 1) row.add();
        if (step % 5 == 2) row.remove(static_cast<std::size_t>(step) % row.bodies.size());
        if (step % 7 == 3) { // seen by no step: two come, one goes at once, and its slot is given again
            row.add();
            row.add();
            row.remove(row.bodies.size() - 2);
            if (step > 20) row.add();
        }
        if (step == 25) { // all but one at once
            while (row.bodies.size() > 1) row.remove(0);
            for (int i = 0; i < 4; ++i) row.add();
        }
        row.step();
        recorder.record();
        const auto ids = row.scene.bodies();
        EXPECT_EQ(ids.size(), row.bodies.size());
    }
    EXPECT_EQ(recorder.hash(), row.hash.hex());
    recorder.finish();
    EXPECT_EQ(recorder.steps(), 40u);
    expect_same_contacts(file, row.hash.hex(), GetParam(), 40);
    EXPECT_EQ(recording::Reader(file.path()).shapes().size(), 2u); // however many bodies have them
    EXPECT_EQ(recording::Reader(file.path()).info().scene, "row");
}

INSTANTIATE_TEST_SUITE_P(Methods, RecorderOf, testing::ValuesIn(methods),
                         [](const auto& one) { return std::string(to_string(one.param)); });

TEST(Recorder, BeginsInMidLife) {
    const TemporaryFile file;
    Row row(Method::certified);
    for (int i = 0; i < 8; ++i) row.add();
    for (int step = 0; step < 30; ++step) { // slots get generations, and some stay empty
        row.remove(static_cast<std::size_t>(step) % row.bodies.size());
        if (step < 27) row.add();
        row.step();
    }
    Recorder recorder(file.path(), row.scene);
    ContactHash hash;
    for (std::uint32_t step = 0; step < 20; ++step) {
        if (step % 3 == 0) row.add();
        if (step % 4 == 1) row.remove(0);
        row.step();
        hash.add(step, row.scene.contacts());
        recorder.record();
    }
    recorder.finish();
    expect_same_contacts(file, hash.hex(), Method::certified, 20);
}

TEST(Recorder, OfAnEmptySceneKnowsHowManyBodiesCame) {
    const TemporaryFile file;
    Row row(Method::certified);
    Recorder recorder(file.path(), row.scene);
    for (int i = 0; i < 3; ++i) row.add();
    row.step();
    recorder.record();
    recorder.finish();
    EXPECT_EQ(recording::Reader(file.path()).info().bodies, 3u);
}

TEST(Recorder, WithoutAnEndItCanBeReplayed) {
    const TemporaryFile file;
    Row row(Method::standard);
    for (int i = 0; i < 4; ++i) row.add();
    {
        Recorder recorder(file.path(), row.scene);
        for (int step = 0; step < 5; ++step) {
            row.step();
            recorder.record();
        }
    }
    recording::Reader reader(file.path());
    EXPECT_EQ(reader.steps(), 5u);
    EXPECT_FALSE(reader.hash());
    recording::ReplayOptions options;
    options.settings = settings_of(Method::standard);
    EXPECT_EQ(recording::replay(reader, options).hash, row.hash.hex());
}

std::string message_of(const std::function<void()>& call) {
    try {
        call();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(Recorder, SaysWhatItCannotRecord) {
    const TemporaryFile file;
    Row row(Method::predictive);
    for (int i = 0; i < 4; ++i) row.add();
    EXPECT_NE(message_of([&] { Recorder("/nowhere/at/all.glb", row.scene); }).find("/nowhere/at/all.glb"),
              std::string::npos);
    RecorderOptions still;
    still.dt = 0;
    EXPECT_NE(message_of([&] { Recorder(file.path(), row.scene, still); }), "");
    RecorderOptions wordy;
    wordy.mesh_source = std::string(std::size_t{1} << 20, 'x');
    EXPECT_NE(message_of([&] { Recorder(file.path(), row.scene, wordy); }).find("shorten them"), std::string::npos);
    row.step();
    EXPECT_NE(message_of([&] { Recorder(file.path(), row.scene); }).find("before the scene's first step"),
              std::string::npos);

    Row other(Method::standard);
    other.add();
    Recorder recorder(file.path(), other.scene);
    other.step();
    recorder.record();
    other.scene.set_settings(settings_of(Method::certified)); // the same contacts
    other.step();
    recorder.record();
    Settings ray = settings_of(Method::certified);
    ray.direction = Direction::ray;
    other.scene.set_settings(ray);
    other.step();
    EXPECT_NE(message_of([&] { recorder.record(); }).find("have changed"), std::string::npos);
}

TEST(Recorder, AStepThatIsRefusedIsNotInTheHash) {
    const TemporaryFile file;
    Row row(Method::standard);
    for (int i = 0; i < 4; ++i) row.add();
    Recorder recorder(file.path(), row.scene);
    ContactHash hash;
    row.step();
    recorder.record();
    hash.add(0, row.scene.contacts());
    row.step();
    row.remove(1);
    EXPECT_NE(message_of([&] { recorder.record(); }).find("body 1 (generation 0) is not there"), std::string::npos);
    row.step();
    recorder.record();
    hash.add(1, row.scene.contacts());
    recorder.finish();
    EXPECT_EQ(recorder.hash(), hash.hex());
    expect_same_contacts(file, hash.hex(), Method::standard, 2);
}

TEST(Recorder, EndsOnce) {
    const TemporaryFile file;
    Row row(Method::standard);
    row.add();
    Recorder recorder(file.path(), row.scene);
    row.step();
    recorder.record();
    recorder.finish();
    EXPECT_NE(message_of([&] { recorder.finish(); }), "");
    row.step();
    EXPECT_NE(message_of([&] { recorder.record(); }), "");
    EXPECT_EQ(recording::Reader(file.path()).steps(), 1u);
}

TEST(Recorder, NamesAFileThatIsGone) {
    const TemporaryFile file;
    Row row(Method::standard);
    row.add();
    Recorder recorder(file.path(), row.scene);
    row.step();
    recorder.record();
    std::filesystem::remove(file.path());
    EXPECT_NE(message_of([&] { recorder.finish(); }).find(file.path().string()), std::string::npos);
}

} // namespace
} // namespace raycontact
