// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/moving_crowd.h"
#include "narrow_phase.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace raycontact::device_test {

/// A narrow phase, and what tells it which bodies moved.
class Stepper {
public:
    Stepper(const MovingCrowd& crowd, const Settings& settings, Opener open_other = {})
        : narrow(settings, cpu(), std::move(open_other)) {
        for (const auto& shape : crowd.shapes) narrow.parts().add_shape(shape);
    }
    std::span<const Contact> step(const MovingCrowd& crowd, const SlotChanges& moved) {
        pairs.set_all(narrow.parts().executor(), crowd.pairs);
        narrow.step(crowd.bodies, moved, pairs, stats);
        pairs.step_done();
        return contacts();
    }
    std::span<const Contact> contacts() const { return narrow.contacts().all(); }
    /// Tells the choice of such times that the pairs must go to the other part.
    void turn() {
        DeviceChoice& choice = *narrow.choice();
        const std::size_t before = choice.part();
        for (double ms = 1e3; choice.part() == before && ms < 1e30; ms *= 1.5) choice.record(1000, ms);
        EXPECT_NE(choice.part(), before);
    }

    NarrowPhase narrow;
    OpenPairs pairs;
    StepStats stats;

private:
    static std::vector<OpenDevice> cpu() {
        std::vector<OpenDevice> opened;
        opened.push_back(open_device("cpu", 1));
        return opened;
    }
};

inline Settings automatic(Method method, Features features, bool speculative = false) {
    Settings settings;
    settings.method = method;
    settings.features = features;
    settings.speculative = speculative ? Speculative::on : Speculative::off;
    return settings;
}

/// All pairs go to and fro between the CPU and another device: each step has the contacts that the CPU alone finds.
/// moving: one body of so many moves in a step.
inline void expect_the_cpus_contacts(const Settings& settings, const Opener& open_other, std::size_t moving) {
    MovingCrowd crowd(18, 1.0);
    for (PlacedBody& body : crowd.bodies) body.next = body.centred;
    Stepper alone(crowd, settings), turned(crowd, settings, open_other);
    SlotChanges moved;
    moved.make_room(crowd.bodies.size());
    std::size_t here = 0, there = 0, contacts = 0;
    const std::vector<SlotPair> all = crowd.pairs;
    for (std::size_t step = 0; step < 26; ++step) {
        const std::string where = std::string(to_string(settings.method)) + ", features "
                                  + std::string(to_string(settings.features)) + ", step " + std::to_string(step);
        for (const std::size_t at : {3u, 6u, 7u, 11u, 12u, 14u, 20u})
            if (step == at) turned.turn();
        crowd.pairs = all;
        if (step % 3 == 1) crowd.pairs.erase(crowd.pairs.begin() + 4, crowd.pairs.begin() + 30);
        const auto expected = alone.step(crowd, moved);
        const auto found = turned.step(crowd, moved);
        ASSERT_TRUE(same(found, expected)) << where;
        EXPECT_EQ(turned.stats.contacts_new, alone.stats.contacts_new) << where;
        EXPECT_EQ(turned.stats.contacts_lost, alone.stats.contacts_lost) << where;
        EXPECT_EQ(turned.stats.contacts_speculative, alone.stats.contacts_speculative) << where;
        EXPECT_EQ(turned.stats.pairs, crowd.pairs.size());
        EXPECT_TRUE(turned.stats.warnings.empty()) << turned.stats.warnings.front();
        for (std::size_t part = 0; part < turned.stats.details.work.size(); ++part) {
            const std::uint64_t own = turned.stats.details.work[part].pairs;
            EXPECT_TRUE(own == 0 || own == crowd.pairs.size()) << where << ": they are all on one";
            if (own > 0) ++(part == 0 ? here : there);
        }
        contacts += found.size();
        moved.step_done();
        const std::vector<PlacedBody> before = crowd.bodies;
        crowd.move();
        for (BodySlot i = 0; i < crowd.bodies.size(); ++i)
            if (i % moving == step % moving)
                moved.mark(i);
            else
                crowd.bodies[i] = before[i];
        for (PlacedBody& body : crowd.bodies) body.next = body.centred;
    }
    EXPECT_GT(here, 5u);
    EXPECT_GT(there, 5u);
    EXPECT_GT(contacts, 500u);
}

} // namespace raycontact::device_test
