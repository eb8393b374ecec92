// SPDX-License-Identifier: Apache-2.0
// Devices "auto": all pairs go from the CPU to another device and back, which may fail, or be missing.
#include "device/fake.h"
#include "device/turning.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace raycontact {
namespace {

using device_test::automatic;
using device_test::Fault;
using device_test::MovingCrowd;
using device_test::open_fake;
using device_test::same;
using device_test::Script;
using device_test::Stepper;

constexpr Method methods[] = {Method::standard, Method::certified, Method::iterative, Method::predictive};

Opener fake(const std::shared_ptr<Script>& script, bool shares_memory) {
    return [=] { return std::optional(open_fake("fake:1", script, shares_memory)); };
}

class AutoDevices : public ::testing::TestWithParam<Method> {};

TEST_P(AutoDevices, HaveTheContactsOfTheCpuAlone) {
    for (const Features features : {Features::vertices, Features::edges})
        for (const bool speculative : {false, true})
            for (const bool shares_memory : {true, false})
                for (const std::size_t moving : {1u, 6u})
                    device_test::expect_the_cpus_contacts(automatic(GetParam(), features, speculative),
                                                          fake(std::make_shared<Script>(), shares_memory), moving);
}

// Each call that the device is asked for while it is opened and tried fails. Returns how many there were.
std::size_t fail_in_trial(Method method, Fault fault, std::size_t at) {
    MovingCrowd crowd(8, 0.7);
    const auto script = std::make_shared<Script>();
    script->start(fault, at);
    Stepper alone(crowd, automatic(method, Features::vertices));
    Stepper tried(crowd, automatic(method, Features::vertices), fake(script, false));
    SlotChanges moved;
    std::size_t warned = 0;
    for (int step = 0; step < 5; ++step) {
        if (step == 1) tried.turn();
        const std::string where =
            std::string(to_string(method)) + ", call " + std::to_string(at) + ", step " + std::to_string(step);
        tried.step(crowd, moved);
        alone.step(crowd, moved);
        moved.forget();
        // Rays that are followed begin anew on the CPU.
        if (method == Method::standard || method == Method::certified) {
            EXPECT_TRUE(same(tried.contacts(), alone.contacts())) << where;
        }
        EXPECT_GT(tried.contacts().size(), 20u) << where;
        EXPECT_EQ(tried.stats.pairs, crowd.pairs.size()) << where;
        warned += tried.stats.warnings.size();
        crowd.move();
    }
    const std::string told = tried.narrow.device_choice();
    if (script->failed > 0) {
        EXPECT_EQ(warned, 1u) << told;
        EXPECT_EQ(tried.narrow.choice()->part(), 0u);
        EXPECT_TRUE(told == "cpu: fake:1 failed" || told == "cpu: the GPU does not open") << told;
    } else {
        EXPECT_EQ(warned, 0u);
        EXPECT_EQ(tried.stats.details.work.at(1).pairs, crowd.pairs.size());
    }
    return script->failed > 0 ? 0 : script->calls.size();
}

TEST_P(AutoDevices, GoOnWithoutOneThatFailsInItsTrial) {
    const std::size_t calls = fail_in_trial(GetParam(), Fault::none, 0);
    EXPECT_GT(calls, 50u);
    for (const Fault fault : {Fault::once, Fault::watchdog})
        for (std::size_t at = 0; at < calls && !HasFailure(); ++at) {
            // A watchdog stops nothing where the device waits no more.
            if (fail_in_trial(GetParam(), fault, at) != 0) {
                EXPECT_EQ(fault, Fault::watchdog) << at;
            }
        }
}
INSTANTIATE_TEST_SUITE_P(Each, AutoDevices, ::testing::ValuesIn(methods),
                         [](const auto& test) { return std::string(to_string(test.param)); });

// The CPU's part fails in a step in which another device has all pairs, and the other way round.
TEST(AutoDevice, IsWhatIsLeft) {
    MovingCrowd crowd(12, 0.9);
    const auto first = std::make_shared<Script>(), second = std::make_shared<Script>();
    for (const auto& failing : {first, second}) {
        for (const auto& script : {first, second}) script->start(Fault::none, 0);
        Stepper alone(crowd, automatic(Method::certified, Features::vertices));
        std::vector<OpenDevice> opened;
        opened.push_back(open_fake("fake:0", first, true));
        NarrowPhase narrow(automatic(Method::certified, Features::vertices), std::move(opened), fake(second, false));
        for (const auto& shape : crowd.shapes) narrow.parts().add_shape(shape);
        SlotChanges moved;
        OpenPairs pairs;
        StepStats stats;
        std::uint64_t lost = 0;
        for (int step = 0; step < 12; ++step) {
            if (step == 2)
                for (double ms = 1e3; narrow.choice()->part() == 0; ms *= 1.5) narrow.choice()->record(1000, ms);
            if (step == 4) failing->start(Fault::lost, 0);
            // The first part, which has none, asks its device for nothing: it fails once it is told of a shape.
            if (step == 6) narrow.parts().add_shape(prepared_shape(scenes::scene_model("knot", 300).mesh));
            pairs.set_all(narrow.parts().executor(), crowd.pairs);
            narrow.step(crowd.bodies, moved, pairs, stats);
            pairs.step_done();
            lost += stats.devices_lost;
            EXPECT_TRUE(same(narrow.contacts().all(), alone.step(crowd, moved))) << step;
            moved.forget();
            crowd.move();
        }
        EXPECT_EQ(lost, 1u);
        EXPECT_EQ(narrow.device_choice(), failing == first ? "fake:1: fake:0 failed" : "fake:0: fake:1 failed");
    }
}

TEST(AutoDevice, IsTheCpuWhereThereIsNoOther) {
    MovingCrowd crowd(10, 0.8);
    int asked = 0;
    const Opener openers[] = {[&]() -> std::optional<OpenDevice> {
                                  ++asked;
                                  return std::nullopt;
                              },
                              [&]() -> std::optional<OpenDevice> {
                                  ++asked;
                                  throw InputError("its driver is too old");
                              },
                              [&]() -> std::optional<OpenDevice> {
                                  ++asked;
                                  throw std::bad_alloc();
                              }};
    for (const Opener& opener : openers) {
        Stepper scene(crowd, automatic(Method::certified, Features::vertices), opener);
        SlotChanges moved;
        asked = 0;
        for (int step = 0; step < 6; ++step) {
            if (step == 3) {
                EXPECT_EQ(asked, 0) << "drivers are asked only where a GPU could be faster";
                scene.turn();
            }
            scene.step(crowd, moved);
            moved.forget();
            const bool told = step == 3 && &opener != &openers[0];
            ASSERT_EQ(scene.stats.warnings.size(), told ? 1u : 0u) << step;
            EXPECT_EQ(scene.stats.devices_lost, 0u);
            EXPECT_GT(scene.contacts().size(), 50u);
            crowd.move();
        }
        EXPECT_EQ(asked, 1);
        EXPECT_EQ(scene.narrow.device_choice(),
                  &opener == &openers[0] ? "cpu: there is no GPU" : "cpu: the GPU does not open");
    }
}

TEST(AutoDevice, IsNotMeasuredWhereARunMustRepeat) {
    MovingCrowd crowd(10, 0.8);
    Settings settings = automatic(Method::certified, Features::vertices);
    settings.execution.schedule = Schedule::counted;
    Stepper scene(crowd, settings, fake(std::make_shared<Script>(), true));
    for (int i = 0; i < 100; ++i) scene.narrow.choice()->record(1000, 1000);
    EXPECT_EQ(scene.narrow.choice()->part(), 0u);
    EXPECT_TRUE(scene.narrow.device_choice().starts_with("cpu: schedule counted")) << scene.narrow.device_choice();
    EXPECT_EQ(Stepper(crowd, settings).narrow.device_choice(), "cpu: as given");
}

// Shapes that came, went and were prepared before the other device was there have the same places on it.
TEST(AutoDevice, HasTheShapesOfTheOther) {
    for (const bool shares_memory : {true, false}) {
        MovingCrowd crowd(12, 0.9);
        const Settings settings = automatic(Method::standard, Features::edges);
        Stepper alone(crowd, settings), turned(crowd, settings, fake(std::make_shared<Script>(), shares_memory));
        const auto gone = Shape::make(scenes::scene_model("gear", 150).mesh);
        const auto late = Shape::make(scenes::scene_model("knot", 150).mesh);
        SlotChanges moved;
        for (int step = 0; step < 14; ++step) {
            if (step == 2) turned.turn();
            if (step == 8) turned.turn();
            if (step == 5) late->prepare();
            for (Stepper* one : {&alone, &turned}) {
                Parts& parts = one->narrow.parts();
                if (step == 1) parts.add_shape(gone);
                if (step == 1) parts.add_shape(late);
                if (step == 1) parts.remove_shape(gone.get());
                if (step == 6) parts.accelerate_shapes();
                if (step == 10) parts.remove_shape(crowd.shapes[2].get());
                parts.pack_shapes();
            }
            for (std::size_t i = 0; i < crowd.bodies.size(); ++i) {
                PlacedBody& body = crowd.bodies[i];
                if (step >= 1 && i % 4 == 3) body.shape = late.get();
                if (step >= 10 && body.shape == crowd.shapes[2].get()) body.shape = crowd.shapes[0].get();
                body.shape_index = alone.narrow.parts().index_of(body.shape);
                EXPECT_EQ(turned.narrow.parts().index_of(body.shape), body.shape_index);
            }
            EXPECT_TRUE(same(turned.step(crowd, moved), alone.step(crowd, moved))) << step;
            EXPECT_EQ(turned.narrow.parts().plain_shapes(), alone.narrow.parts().plain_shapes());
            moved.forget();
            crowd.move();
        }
        EXPECT_EQ(turned.narrow.parts().size(), 2u);
    }
}

} // namespace
} // namespace raycontact
