// SPDX-License-Identifier: Apache-2.0
// Once a scene has seen its worst step, further steps allocate nothing; and one for which there was no memory leaves
// nothing behind.
#include "prepared_shape.h"
#include "scenes/models/model.h"

#include <raycontact/scene.h>

#include <atomic>
#include <cstdlib>
#include <gtest/gtest.h>
#include <malloc.h>
#include <new>

namespace {
std::atomic<std::uint64_t> allocations{0};
std::atomic<std::int64_t> bytes_held{0};
std::atomic<std::int64_t> allocations_left{-1}; // before one fails; below 0: none does

void* counted(std::size_t bytes, std::size_t alignment) {
    ++allocations;
    if (allocations_left >= 0 && allocations_left-- == 0) throw std::bad_alloc();
    void* memory = nullptr;
    if (posix_memalign(&memory, alignment, bytes > 0 ? bytes : 1) != 0) throw std::bad_alloc();
    bytes_held += static_cast<std::int64_t>(malloc_usable_size(memory));
    return memory;
}

void free_counted(void* memory) {
    bytes_held -= static_cast<std::int64_t>(malloc_usable_size(memory));
    std::free(memory);
}
} // namespace

void* operator new(std::size_t bytes) {
    return counted(bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
    return counted(bytes, static_cast<std::size_t>(alignment));
}
// A sanitizer has one of its own, whose memory the operator below must not free.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
    try {
        return counted(bytes, alignof(std::max_align_t));
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}
void operator delete(void* memory) noexcept {
    free_counted(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    free_counted(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    free_counted(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    free_counted(memory);
}

namespace raycontact {
namespace {

// Bodies that swing back and forth, so that every state returns.
void move(Scene& scene, int step) {
    const int phase = step % 16;
    for (std::uint32_t body = 0; body < 64; ++body) {
        const double sway = 0.02 * (phase < 8 ? phase : 16 - phase);
        const std::uint32_t column = body % 4, row = body / 4 % 4, layer = body / 16;
        const Vec3 at{0.7 * column + sway, 0.7 * row - sway, 0.7 * layer};
        scene.set_pose({body}, pose_from_quaternion(at, 1, 0.1 * body, sway, 0.3));
    }
}

constexpr Method methods[] = {Method::standard, Method::iterative, Method::predictive, Method::certified};

void expect_none_after_warm_up(Features features, const std::shared_ptr<const Shape>& shape) {
    for (const Method method : methods)
        for (const std::uint32_t threads : {1u, 2u})
            for (const bool given : {false, true}) {
                Settings settings;
                settings.features = features;
                settings.method = method;
                settings.execution.devices = "cpu"; // a trial of another allocates
                settings.execution.threads = threads;
                // Patches of faces are made anew in each step.
                const Direction other = features == Features::edges ? Direction::ray : Direction::weighted;
                settings.direction = given ? other : Direction::reprojected;
                Scene scene(settings);
                for (std::uint32_t body = 0; body < 64; ++body) scene.add(shape);
                std::vector<Pair> pairs;
                const auto step = [&](int i) {
                    move(scene, i);
                    if (given)
                        scene.find_contacts(pairs);
                    else
                        scene.find_contacts();
                };
                for (std::uint32_t a = 0; a < 64; ++a)
                    for (std::uint32_t b = a + 1; b < 64; ++b) pairs.emplace_back(BodyId{a}, BodyId{b});
                // What a pair keeps follows its speed, smoothed: a few periods until every state has returned.
                for (int i = 0; i < 96; ++i) step(i);
                const std::uint64_t before = allocations;
                std::uint64_t contacts = 0;
                for (int i = 96; i < 160; ++i) {
                    step(i);
                    contacts += scene.stats().contacts;
                }
                EXPECT_EQ(allocations - before, 0u) << to_string(method) << ", " << threads << " threads";
                EXPECT_GT(contacts, 9000u);
            }
}

TEST(Allocations, NoneAfterWarmUp) {
    expect_none_after_warm_up(Features::vertices, prepared_shape(scenes::scene_model("knot", 902).mesh));
}

TEST(Allocations, NoneAfterWarmUpWithEdges) {
    expect_none_after_warm_up(Features::edges, prepared_shape(scenes::scene_model("knot", 60).mesh));
}

// Pairs that come and go take what others left.
TEST(Allocations, NoneForPairsThatReturn) {
    const auto shape = prepared_shape(scenes::scene_model("knot", 902).mesh);
    for (const Method method : methods) {
        Settings settings;
        settings.method = method;
        settings.execution.devices = "cpu"; // a trial of another allocates
        settings.execution.threads = 1;
        Scene scene(settings);
        for (std::uint32_t body = 0; body < 64; ++body) scene.add(shape);
        // Of different length, so that what is kept for a part of the pairs comes and goes, too.
        std::vector<Pair> pairs[3];
        for (std::uint32_t a = 0; a < 64; ++a)
            for (std::uint32_t b = a + 1; b < 64; ++b)
                for (std::uint32_t part = 0; part < 3; ++part)
                    if (a >= 4 * part && (a + b) % 3 != part) pairs[part].emplace_back(BodyId{a}, BodyId{b});
        const auto step = [&](int i) {
            move(scene, i);
            scene.find_contacts(pairs[i / 2 % 3]);
        };
        for (int i = 0; i < 192; ++i) step(i);
        const std::uint64_t before = allocations;
        for (int i = 192; i < 288; ++i) step(i);
        EXPECT_EQ(allocations - before, 0u) << to_string(method);
        EXPECT_GT(scene.stats().contacts, 100u);
    }
}

// Bodies that come and go, with steps and without: not a byte more, and lists by slot are no longer.
TEST(Allocations, NoneForAMillionBodiesThatComeAndGo) {
    const auto shape = prepared_shape(scenes::scene_model("knot", 902).mesh);
    Settings settings;
    settings.execution.devices = "cpu"; // a trial of another allocates
    settings.execution.threads = 1;
    Scene scene(settings);
    for (std::uint32_t body = 0; body < 8; ++body)
        scene.add(shape, pose_from_quaternion({0.7 * double(body), 0, 0}, 1, 0, 0, 0));
    const auto round = [&](int i) {
        BodyId guests[4];
        for (int k = 0; k < 4; ++k)
            guests[k] = scene.add(shape, pose_from_quaternion({0.7 * k, 0.5, 0.1 * (i % 4)}, 1, 0.1 * k, 0, 0));
        if (i % 64 == 0) scene.find_contacts();
        if (i % 64 == 1) scene.find_contacts(); // with others
        for (const BodyId guest : guests) {
            EXPECT_LT(guest.slot, 16u);
            scene.remove(guest);
        }
    };
    for (int i = 0; i < 2048; ++i) round(i);
    const std::uint64_t before = allocations;
    for (int i = 2048; i < 250000; ++i) round(i);
    EXPECT_EQ(allocations - before, 0u);
}

TEST(Allocations, AHundredThousandBodiesAtOnceAreGivenBack) {
    const auto shape = prepared_shape(scenes::scene_model("knot", 902).mesh);
    Scene scene;
    const BodyId stays = scene.add(shape);
    scene.find_contacts(std::span<const Pair>{});
    const std::int64_t before = bytes_held;
    std::vector<BodyId> guests;
    guests.reserve(100000);
    for (int i = 0; i < 100000; ++i) guests.push_back(scene.add(shape));
    const std::int64_t most = bytes_held - before;
    for (const BodyId guest : guests) scene.remove(guest);
    guests = std::vector<BodyId>();
    scene.find_contacts(std::span<const Pair>{});
    EXPECT_GT(most, 100000 * 200);
    EXPECT_LT(bytes_held - before, 100000 * 40); // which generation each slot is in
    EXPECT_EQ(scene.pose(stays), Pose{});
}

// Whichever allocation of a step fails: the step repeated, and repeated again, gives the contacts of a fresh scene.
void expect_nothing_left(Features features, const std::shared_ptr<const Shape>& shape, bool speculative = false) {
    const std::uint32_t bodies = speculative ? 9 : 27;
    const auto pose_of = [](std::uint32_t body, double spacing) {
        const std::uint32_t column = body % 3, row = body / 3 % 3, layer = body / 9;
        const Vec3 at{spacing * column, spacing * row, spacing * layer};
        return pose_from_quaternion(at, 1, 0.1 * body, 0.2, 0.3);
    };
    for (const Method method : methods) {
        Settings settings;
        settings.method = method;
        settings.execution.devices = "cpu"; // a trial of another allocates
        settings.execution.threads = 1;
        settings.features = features;
        settings.speculative = speculative ? Speculative::on : Speculative::off;
        settings.speculative_margin = 0.02;
        std::uint64_t failures = 0;
        for (std::int64_t k = 0;; ++k) {
            Scene scene(settings);
            for (std::uint32_t body = 0; body < bodies; ++body) scene.add(shape, pose_of(body, 0.8));
            ASSERT_GT(scene.find_contacts().size(), 0u);
            for (std::uint32_t body = 0; body < bodies; ++body) scene.set_pose({body}, pose_of(body, 0.6));
            bool failed = false;
            allocations_left = k;
            try {
                scene.find_contacts();
            } catch (const std::bad_alloc&) {
                failed = true;
            }
            allocations_left = -1;
            if (!failed) break;
            ++failures;
            EXPECT_TRUE(scene.contacts().empty());
            Scene fresh(settings);
            for (std::uint32_t body = 0; body < bodies; ++body) fresh.add(shape, pose_of(body, 0.6));
            const auto expected = fresh.find_contacts();
            for (int again = 0; again < 2; ++again) {
                // All stand still, as they do in a scene that knows no last pose.
                for (const BodyId body : scene.bodies()) scene.set_next_pose({body}, scene.pose({body}));
                const auto found = scene.find_contacts();
                ASSERT_EQ(found.size(), expected.size()) << to_string(method) << ", allocation " << k;
                for (std::size_t i = 0; i < found.size(); ++i) {
                    ASSERT_TRUE(found[i].feature == expected[i].feature);
                    ASSERT_EQ(found[i].depth, expected[i].depth);
                }
            }
        }
        EXPECT_GT(failures, 12u) << to_string(method);
    }
}

// And who holds what was found before still has it.
TEST(Allocations, AStepOfOtherPairsThatFailsDoesNotHaveTheOldOnes) {
    const auto shape = prepared_shape(scenes::scene_model("knot", 60).mesh);
    Settings settings;
    settings.execution.devices = "cpu"; // a trial of another allocates
    settings.execution.threads = 1;
    std::uint64_t failures = 0;
    for (std::int64_t k = 0;; ++k) {
        Scene scene(settings);
        std::vector<BodyId> bodies;
        for (int i = 0; i < 3; ++i) bodies.push_back(scene.add(shape, {.translation = {0.2 * i, 0, 0}}));
        const std::vector<Pair> first{{bodies[0], bodies[1]}}, second{{bodies[0], bodies[2]}};
        scene.find_contacts(first);
        const auto held = scene.shared_contacts();
        const std::size_t count = held->size();
        ASSERT_GT(count, 0u);
        allocations_left = k;
        bool failed = false;
        try {
            scene.find_contacts(second);
        } catch (const std::bad_alloc&) {
            failed = true;
        }
        allocations_left = -1;
        if (!failed) break;
        ++failures;
        ASSERT_EQ(held->size(), count) << "allocation " << k;
        scene.find_contacts(second);
        ASSERT_EQ(scene.pairs().size(), 1u);
        ASSERT_EQ(scene.pairs()[0].second, bodies[2]) << "allocation " << k;
    }
    EXPECT_GT(failures, 12u);
}

// Removing needs no memory, nor does it after a scene gave back what it had for many more.
TEST(Allocations, ABodyIsRemovedWhereMemoryLacks) {
    const auto shape = prepared_shape(scenes::scene_model("knot", 60).mesh);
    Settings settings;
    settings.execution.devices = "cpu"; // a trial of another allocates
    settings.execution.threads = 1;
    Scene scene(settings);
    std::vector<BodyId> bodies;
    for (int i = 0; i < 1500; ++i)
        bodies.push_back(scene.add(shape, {.translation = {0.3 * (i % 12), 0.3 * (i / 12 % 12), 0.3 * (i / 144)}}));
    scene.find_contacts();
    const std::size_t most = scene.pairs().size();
    for (int i = 20; i < 1500; ++i) scene.remove(bodies[std::size_t(i)]);
    for (int step = 0; step < 6; ++step) {
        scene.set_pose(bodies[0], {.translation = {0.001 * step, 0, 0}});
        scene.find_contacts();
    }
    ASSERT_GT(scene.pairs().size(), 10u);
    ASSERT_GT(most, 100 * scene.pairs().size());
    allocations_left = 0;
    scene.remove(bodies[1]);
    allocations_left = -1;
    EXPECT_FALSE(scene.has(bodies[1]));
}

TEST(Allocations, AStepThatFailsLeavesNothing) {
    expect_nothing_left(Features::vertices, prepared_shape(scenes::scene_model("knot", 902).mesh));
}

TEST(Allocations, ASpeculativeStepThatFailsLeavesNothing) {
    expect_nothing_left(Features::edges, prepared_shape(scenes::scene_model("knot", 60).mesh), true);
}

TEST(Allocations, AStepWithEdgesThatFailsLeavesNothing) {
    expect_nothing_left(Features::edges, prepared_shape(scenes::scene_model("knot", 60).mesh));
}

} // namespace
} // namespace raycontact
