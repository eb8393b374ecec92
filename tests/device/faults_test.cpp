// SPDX-License-Identifier: Apache-2.0
// Several devices, of which some fail: at each call of a step, in each way. The step's contacts are complete, and those
// after it, too.
#include "box_changes.h"
#include "device/fake.h"
#include "device/listed_pairs.h"
#include "device/moving_crowd.h"
#include "narrow_phase.h"
#include "prepared_shape.h"

#include <array>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

using device_test::Fault;
using device_test::ListedPairs;
using device_test::MovingCrowd;
using device_test::open_fake;
using device_test::same;
using device_test::Script;

constexpr Method methods[] = {Method::standard, Method::certified, Method::iterative, Method::predictive};

bool depends_on_state(Method method) {
    return method == Method::iterative || method == Method::predictive;
}

Settings settings_of(Method method) {
    Settings settings;
    settings.method = method;
    settings.execution.schedule = Schedule::counted;
    return settings;
}

// A narrow phase on fake devices.
class Rig {
public:
    Rig(const MovingCrowd& crowd, Method method, std::size_t devices, bool shares_memory = true)
        : scripts(make_scripts(devices)), narrow(settings_of(method), open(shares_memory)) {
        for (const auto& shape : crowd.shapes) narrow.parts().add_shape(shape);
    }
    std::span<const Contact> step(const MovingCrowd& crowd) { return step(crowd, crowd.pairs); }
    std::span<const Contact> step(const MovingCrowd& crowd, std::span<const SlotPair> listed) {
        pairs.set_all(narrow.parts().executor(), listed);
        narrow.step(crowd.bodies, moved, pairs, stats);
        pairs.step_done();
        moved.forget();
        return contacts();
    }
    std::span<const Contact> contacts() const { return narrow.contacts().all(); }

    std::vector<std::shared_ptr<Script>> scripts;
    NarrowPhase narrow;
    SlotChanges moved;
    OpenPairs pairs;
    StepStats stats;

private:
    static std::vector<std::shared_ptr<Script>> make_scripts(std::size_t count) {
        std::vector<std::shared_ptr<Script>> made;
        for (std::size_t i = 0; i < count; ++i) made.push_back(std::make_shared<Script>());
        return made;
    }
    std::vector<OpenDevice> open(bool shares_memory) const {
        std::vector<OpenDevice> opened;
        for (std::size_t i = 0; i < scripts.size(); ++i)
            opened.push_back(open_fake("fake:" + std::to_string(i), scripts[i], shares_memory));
        return opened;
    }
};

// Two parts on the CPU: some pairs leave the first for the second in one step, as new ones. What a fault must come to.
class Reference {
public:
    Reference(const MovingCrowd& crowd, Method method) : settings_(settings_of(method)) {
        for (const auto& shape : crowd.shapes)
            for (Part* part : {&first_, &second_}) part->shapes().add(shape);
    }
    std::vector<Contact> step(const MovingCrowd& crowd, const std::vector<SlotPair>& gone) {
        std::vector<SlotPair> stay;
        std::ranges::set_difference(crowd.pairs, gone, std::back_inserter(stay));
        std::vector<Contact> contacts = contacts_of(first_, first_pairs_, crowd, stay),
                             others = contacts_of(second_, second_pairs_, crowd, gone);
        contacts.insert(contacts.end(), others.begin(), others.end());
        std::ranges::stable_sort(contacts, {}, [](const Contact& c) { return pair_of(c); });
        return contacts;
    }

private:
    std::vector<Contact> contacts_of(Part& part, ListedPairs& own, const MovingCrowd& crowd,
                                     std::span<const SlotPair> pairs) {
        moved_.forget();
        part.begin(crowd.bodies, moved_, own.next(pairs), settings_);
        std::vector<Contact> contacts;
        part.end(contacts);
        own.step_done();
        return contacts;
    }

    Settings settings_;
    SlotChanges moved_;
    Part first_{open_device("cpu", 1)}, second_{open_device("cpu", 1)};
    ListedPairs first_pairs_, second_pairs_;
};

constexpr int last_step = 4, faulty_step = 2;

// Runs some steps; in one of them device 1 of three fails at its call `at`. Returns how many calls it was asked for.
std::size_t run_with_fault(Method method, Fault fault, std::size_t at, bool shares_memory) {
    MovingCrowd crowd(14, 1.0);
    Rig rig(crowd, method, 3, shares_memory);
    Reference reference(crowd, method);
    std::vector<SlotPair> gone;
    std::size_t calls = 0, contacts = 0;
    for (int step = 0; step < last_step; ++step) {
        const std::string where = std::string(to_string(method)) + ", fault " + std::to_string(int(fault)) + " at call "
                                  + std::to_string(at) + ", step " + std::to_string(step);
        Script& script = *rig.scripts[1];
        if (step == faulty_step) script.start(fault, at);
        const std::vector<SlotPair> own = rig.narrow.assignment().all_on(1).pairs;
        const std::span<const Contact> found = rig.step(crowd);
        if (step == faulty_step) {
            calls = script.calls.size();
            const bool lost = script.failed > 0;
            EXPECT_EQ(rig.stats.devices_lost, lost ? 1u : 0u) << where;
            EXPECT_EQ(rig.stats.warnings.size(), lost ? 1u : 0u) << where;
            EXPECT_EQ(rig.stats.details.work.size(), 3u);
            if (lost) {
                EXPECT_NE(rig.stats.warnings[0].find("fake:1"), std::string::npos) << rig.stats.warnings[0];
                gone = own;
                EXPECT_GT(gone.size(), 10u);
                EXPECT_EQ(rig.stats.details.work[1].pairs, 0u);
            }
        }
        EXPECT_EQ(rig.stats.details.work[0].pairs + rig.stats.details.work[1].pairs + rig.stats.details.work[2].pairs,
                  crowd.pairs.size());
        EXPECT_TRUE(same(found, reference.step(crowd, gone))) << where;
        contacts += found.size();
        crowd.move();
    }
    EXPECT_GT(contacts, 500u);
    return calls;
}

class EachCall : public ::testing::TestWithParam<Method> {};

TEST_P(EachCall, MayFail) {
    for (const bool shares_memory : {true, false}) {
        const std::size_t calls = run_with_fault(GetParam(), Fault::none, 0, shares_memory);
        EXPECT_GT(calls, 8u);
        for (const Fault fault : {Fault::once, Fault::lost, Fault::watchdog})
            for (std::size_t at = 0; at < calls; ++at) {
                run_with_fault(GetParam(), fault, at, shares_memory);
                if (HasFailure()) return;
            }
    }
}
INSTANTIATE_TEST_SUITE_P(Faults, EachCall, ::testing::ValuesIn(methods),
                         [](const auto& test) { return std::string(to_string(test.param)); });

// Of three devices 0 fails, and `second` at its call `at`: one of its own, or one for pairs that it takes over. Returns
// how many calls it was asked for, if it did not fail, else 0.
std::size_t run_with_two_faults(Method method, std::size_t second, std::size_t at) {
    MovingCrowd crowd(14, 1.0);
    Rig rig(crowd, method, 3);
    Reference reference(crowd, method);
    std::vector<SlotPair> gone;
    std::size_t calls = 0;
    for (int step = 0; step < last_step; ++step) {
        if (step == faulty_step) {
            rig.scripts[0]->start(Fault::lost, 3);
            rig.scripts[second]->start(Fault::lost, at);
        }
        std::vector<SlotPair> had[3];
        for (std::size_t part = 0; part < 3; ++part) had[part] = rig.narrow.assignment().all_on(part).pairs;
        const std::span<const Contact> found = rig.step(crowd);
        if (step == faulty_step) {
            const bool both = rig.scripts[second]->failed > 0;
            EXPECT_EQ(rig.stats.devices_lost, both ? 2u : 1u);
            if (!both) calls = rig.scripts[second]->calls.size();
            for (const std::size_t part : {std::size_t{0}, second}) {
                if (rig.scripts[part]->failed == 0) continue;
                gone.insert(gone.end(), had[part].begin(), had[part].end());
            }
            std::ranges::sort(gone);
        }
        EXPECT_TRUE(same(found, reference.step(crowd, gone)))
            << to_string(method) << ", device " << second << ", call " << at << ", step " << step;
        crowd.move();
    }
    return calls;
}

TEST(Faults, OneDeviceAfterAnother) {
    for (const Method method : methods) {
        std::size_t calls = 0;
        for (const std::size_t second : {1, 2}) {
            const std::size_t all = run_with_two_faults(method, second, 1000000);
            for (std::size_t at = 0; at < all && !HasFailure(); ++at)
                EXPECT_EQ(run_with_two_faults(method, second, at), 0u);
            calls += all;
        }
        EXPECT_GT(calls, 50u) << to_string(method);
    }
}

// Work on the host goes on with the threads of one that is left.
TEST(Faults, WithoutTheFirstDeviceTheHostHasAnother) {
    MovingCrowd crowd(10, 0.8);
    Rig rig(crowd, Method::standard, 3);
    EXPECT_EQ(&rig.narrow.parts().executor(), &rig.narrow.parts()[0].executor());
    rig.step(crowd);
    crowd.move();
    rig.scripts[0]->start(Fault::lost, 1);
    rig.step(crowd);
    ASSERT_FALSE(rig.narrow.parts().has(0));
    EXPECT_EQ(&rig.narrow.parts().executor(), &rig.narrow.parts()[1].executor());
}

TEST(Faults, WithNoDeviceLeftTheStepFailsAndTheNextBeginsAnew) {
    for (const Method method : methods) {
        MovingCrowd crowd(10, 0.8);
        Rig rig(crowd, method, 2);
        rig.step(crowd);
        crowd.move();
        for (const auto& script : rig.scripts) script->start(Fault::lost, 5);
        try {
            rig.step(crowd);
            FAIL() << "both devices are lost";
        } catch (const DeviceError& error) {
            const std::string text = error.what();
            EXPECT_NE(text.find("fake:0"), std::string::npos) << text;
            EXPECT_NE(text.find("fake:1"), std::string::npos) << text;
        }
        EXPECT_TRUE(rig.contacts().empty());
        for (const auto& script : rig.scripts) script->start(Fault::none, 0);
        rig.step(crowd);
        if (!depends_on_state(method)) {
            EXPECT_TRUE(same(rig.contacts(), Reference(crowd, method).step(crowd, {})));
        }
        EXPECT_GT(rig.contacts().size(), 50u);
    }
}

// The broad phase of a scene: each call of its second step fails, on one device of two, or on the only one.
TEST(Faults, InFindingPairs) {
    for (const std::size_t devices : {2, 1})
        for (const Fault fault : {Fault::once, Fault::lost, Fault::watchdog}) {
            bool failed = true;
            for (std::size_t at = 0; failed && !HasFailure(); ++at) {
                MovingCrowd crowd(200, 3.0);
                Rig rig(crowd, Method::standard, devices, false);
                Parts& parts = rig.narrow.parts();
                WorldBoxes world;
                BoxChanges changes;
                changes.make_room(200);
                const std::vector<BroadPhaseInput::Filter> filters(200);
                std::vector<SlotPair> pairs, left;
                bool whole = true;
                const auto apply = [&](const DeviceBroadPhase::Found& told) {
                    if (told.whole) pairs.clear();
                    left.clear();
                    std::ranges::set_difference(pairs, told.closed, std::back_inserter(left));
                    pairs.clear();
                    std::ranges::merge(left, told.opened, std::back_inserter(pairs));
                };
                // As a scene finds them.
                const auto find = [&] {
                    for (bool found = false; !found;) {
                        Part& part = parts[parts.first()];
                        ASSERT_TRUE(part.can_find_pairs());
                        const auto told = changes.list(parts.executor(), crowd.bodies, {}, filters, world,
                                                       rig.narrow.settings(), part.known_slots());
                        const bool knows_none = std::exchange(whole, true);
                        found = parts.before_step(parts.first(), [&] { apply(part.find_pairs(told, knows_none)); });
                    }
                    whole = false;
                };
                const auto expect = [&] {
                    world.forget();
                    world.update(parts.executor(), crowd.bodies, {}, rig.narrow.settings());
                    BroadPhase host;
                    const auto expected = host.find(parts.executor(), world.tree(), {world.boxes(), filters});
                    EXPECT_TRUE(std::ranges::equal(pairs, expected)) << devices << " devices, call " << at;
                    EXPECT_GT(pairs.size(), 200u);
                };
                find();
                expect();
                crowd.move();
                for (BodySlot i = 0; i < 200; ++i) changes.mark(i);
                rig.scripts[0]->start(fault, at);
                if (devices == 1) {
                    try {
                        find();
                    } catch (const DeviceError&) {
                    }
                    failed = rig.scripts[0]->failed > 0;
                    rig.scripts[0]->start(Fault::none, 0);
                    find();
                } else {
                    find();
                    failed = rig.scripts[0]->failed > 0;
                    EXPECT_EQ(parts.has_news(), failed);
                    EXPECT_EQ(parts.left(), failed ? 1u : 2u);
                }
                expect();
                rig.scripts[0]->start(Fault::none, 0); // a call that was not reached is none of the step's
                rig.step(crowd, pairs);
                EXPECT_EQ(rig.stats.devices_lost, failed && devices == 2 ? 1u : 0u);
                EXPECT_TRUE(failed || at > 5);
            }
        }
}

// A shape that a device has no room for.
TEST(Faults, InAddingAShape) {
    MovingCrowd crowd(10, 0.8);
    const auto more = prepared_shape(scenes::scene_model("torus", 400).mesh);
    for (std::size_t at = 0; at < 20; ++at) {
        Rig rig(crowd, Method::standard, 2);
        rig.step(crowd);
        rig.scripts[0]->start(Fault::once, at);
        rig.narrow.parts().add_shape(more);
        const bool lost = rig.scripts[0]->failed > 0;
        rig.scripts[0]->start(Fault::none, 0);
        rig.step(crowd);
        EXPECT_EQ(rig.stats.warnings.size(), lost ? 1u : 0u);
        EXPECT_EQ(rig.narrow.parts().left(), lost ? 1u : 2u);
        EXPECT_TRUE(same(rig.contacts(), Reference(crowd, Method::standard).step(crowd, {})));
        EXPECT_TRUE(lost || at > 0);
    }
}

// The pairs that the lost one had are those of the step before, and few of the slots are in use by now.
TEST(Faults, BeforeAStepThatGivesPairsOtherSlots) {
    MovingCrowd crowd(100, 0.8);
    std::vector<SlotPair> all;
    for (BodySlot a = 0; a < 100; ++a)
        for (BodySlot b = a + 1; b < 100; ++b) all.emplace_back(a, b);
    crowd.pairs.resize(4);
    Rig rig(crowd, Method::standard, 2);
    rig.step(crowd, all);
    rig.narrow.parts().before_step(1, [] { throw DeviceError("lost"); });
    rig.pairs.set_all(rig.narrow.parts().executor(), crowd.pairs);
    ASSERT_TRUE(rig.pairs.compact(rig.narrow.parts().executor()));
    EXPECT_TRUE(same(rig.step(crowd), Reference(crowd, Method::standard).step(crowd, {})));
    EXPECT_EQ(rig.stats.devices_lost, 1u);
}

// ---- several devices without a fault

// The load is uneven for some steps, so that pairs move. In step `faulty`, device `device` fails at call `at`.
struct Uneven {
    std::uint64_t moved = 0, lost = 0, contacts = 0;
    std::size_t calls = 0;
    int moved_in = -1;
    std::vector<std::array<std::vector<SlotPair>, 2>> had; ///< by step: the pairs of each device
};
// whole: the same without a fault.
Uneven run_uneven(Method method, int faulty, std::size_t device, std::size_t at, const Uneven& whole) {
    MovingCrowd crowd(14, 1.0);
    Rig rig(crowd, method, 2);
    Reference reference(crowd, method);
    Uneven result;
    std::vector<SlotPair> gone;
    for (int step = 0; step < 16; ++step) {
        if (step == 1) { // most pairs of device 1 are over
            const std::vector<SlotPair> own = rig.narrow.assignment().all_on(1).pairs;
            std::vector<SlotPair> over(own.begin() + 5, own.end()), rest;
            std::ranges::set_difference(crowd.pairs, over, std::back_inserter(rest));
            crowd.pairs = rest;
        }
        if (step == faulty) rig.scripts[device]->start(Fault::lost, at);
        const std::span<const Contact> found = rig.step(crowd);
        if (step == faulty) result.calls = rig.scripts[device]->calls.size();
        if (rig.stats.details.pairs_moved > 0 && result.moved_in < 0) result.moved_in = step;
        if (rig.stats.devices_lost > 0) {
            // Pairs that had moved to it before it failed were new in that step as well.
            const int had_in = rig.stats.details.pairs_moved > 0 ? step : step - 1;
            gone = whole.had[static_cast<std::size_t>(had_in)][device];
        }
        if (rig.stats.devices_lost == 0)
            result.had.push_back({rig.narrow.assignment().all_on(0).pairs, rig.narrow.assignment().all_on(1).pairs});
        result.moved += rig.stats.details.pairs_moved;
        result.lost += rig.stats.devices_lost;
        result.contacts += found.size();
        EXPECT_TRUE(same(found, reference.step(crowd, gone)))
            << to_string(method) << ", step " << step << ", device " << device << ", call " << at;
        crowd.move();
    }
    return result;
}

TEST(Balance, MovesPairsWithTheirState) {
    for (const Method method : methods) {
        const Uneven whole = run_uneven(method, -1, 0, 0, {});
        EXPECT_GT(whole.moved, 10u) << to_string(method);
        EXPECT_GE(whole.moved_in, 8);
        EXPECT_EQ(whole.lost, 0u);
        EXPECT_GT(whole.contacts, 500u);
        for (std::size_t device = 0; device < 2; ++device) {
            const std::size_t calls = run_uneven(method, whole.moved_in, device, 1000000, whole).calls;
            for (std::size_t at = 0; at < calls; ++at) {
                EXPECT_EQ(run_uneven(method, whole.moved_in, device, at, whole).lost, 1u);
                if (testing::Test::HasFailure()) return;
            }
        }
    }
}

TEST(SeveralDevices, HaveTheContactsOfOne) {
    for (const Method method : methods)
        for (const std::size_t devices : {1, 3, 8})
            for (const bool shares_memory : {true, false}) {
                MovingCrowd crowd(20, 1.2);
                Rig rig(crowd, method, devices, shares_memory);
                Reference reference(crowd, method);
                for (int step = 0; step < 6; ++step) {
                    EXPECT_TRUE(same(rig.step(crowd), reference.step(crowd, {}))) << to_string(method) << devices;
                    ASSERT_EQ(rig.stats.details.work.size(), devices);
                    std::uint64_t pairs = 0;
                    for (const DeviceWork& work : rig.stats.details.work) {
                        EXPECT_GT(work.pairs, crowd.pairs.size() / devices / 2);
                        EXPECT_GT(work.load, 0);
                        EXPECT_GT(work.ms, 0);
                        pairs += work.pairs;
                    }
                    EXPECT_EQ(pairs, crowd.pairs.size());
                    crowd.move();
                }
            }
}

} // namespace
} // namespace raycontact
