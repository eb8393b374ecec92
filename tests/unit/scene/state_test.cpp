// SPDX-License-Identifier: Apache-2.0
// A scene's state, saved and loaded: later steps repeat bit for bit.
#include <raycontact/primitives.h>
#include <raycontact/scene.h>

#include "reference/meshes.h"
#include "unit/mesh/solids.h"

#include <gtest/gtest.h>

#include <cmath>
#include <ostream>
#include <random>

namespace raycontact {
namespace {

/// Bodies that go round in a box, some of them at a time, by numbers that depend on the step alone.
class Motion {
public:
    explicit Motion(Scene& scene) : scene_(scene) {
        const auto ring = Shape::make(test::torus(12, 6, 0.5, 0.2, 0)),
                   box = Shape::make(reference::box_mesh({0.4, 0.3, 0.5})), capsule = make_capsule(0.3, 0.4);
        for (int i = 0; i < 40; ++i)
            bodies_.push_back(scene_.add(i % 3 == 0 ? box : i % 5 == 1 ? capsule : ring, pose(i, 0)));
        scene_.set_filter(bodies_[3], 2, 0xffffffffu);
        scene_.set_static(bodies_[4], true);
        scene_.set_sensor(bodies_[5], true);
        scene_.set_user_data(bodies_[6], 42);
        scene_.set_speculative_margin(bodies_[7], 0.05);
    }
    explicit Motion(Scene& scene, const std::vector<BodyId>& bodies) : scene_(scene), bodies_(bodies) {}

    void forget(std::size_t body) { bodies_[body] = {}; }
    void move(int step) {
        for (int i = 0; i < int(bodies_.size()); ++i) {
            if (!bodies_[std::size_t(i)].valid()) continue;
            if ((i * 7 + step) % 3 == 0 && i != 4) scene_.set_pose(bodies_[std::size_t(i)], pose(i, step));
            if ((i + step) % 11 == 0) scene_.set_next_pose(bodies_[std::size_t(i)], pose(i, step + 1));
        }
        if (step % 10 != 9) return;
        const auto shape = scene_.shape(bodies_[9]).shared_from_this();
        scene_.remove(bodies_[9]);
        bodies_[9] = scene_.add(shape, pose(9, step));
    }
    const std::vector<BodyId>& bodies() const { return bodies_; }

private:
    static Pose pose(int body, int step) {
        std::mt19937 random{static_cast<std::uint32_t>(body)};
        const auto number = [&] { return double(random()) / 4294967296.0; };
        const double phase = 6.28 * number(), speed = 0.02 + 0.03 * number(), x = 5 * number(), y = 5 * number(),
                     angle = phase + speed * step;
        const double c = std::cos(angle), s = std::sin(angle);
        return {{c, -s, 0, s, c, 0, 0, 0, 1}, {x + 0.3 * c, y + 0.3 * s, 0.6 * std::sin(angle + x)}};
    }

    Scene& scene_;
    std::vector<BodyId> bodies_;
};

/// Of contacts with what is new, of those lost, of touches.
struct Told {
    std::string hash;
    std::size_t fresh = 0, lost = 0, begun = 0, ended = 0, touching = 0;
    std::uint64_t walks = 0;
    bool operator==(const Told&) const = default;
    friend std::ostream& operator<<(std::ostream& out, const Told& told) {
        return out << told.hash << ' ' << told.fresh << ' ' << told.lost << ' ' << told.begun << ' ' << told.ended
                   << ' ' << told.touching;
    }
};
Told step(Scene& scene) {
    scene.find_contacts();
    ContactHash hash(scene.settings().direction, true);
    hash.add(0, scene.contacts());
    Told told{hash.hex(),
              0,
              scene.lost_contacts().size(),
              scene.begun().size(),
              scene.ended().size(),
              scene.touching().size(),
              scene.stats().details.walks};
    for (const Contact& contact : scene.contacts()) told.fresh += contact.is_new ? 1 : 0;
    return told;
}

class SavedState : public testing::TestWithParam<Settings> {};

TEST_P(SavedState, RepeatsToTheBit) {
    for (const bool moves_on : {false, true}) { // poses are set between the last step and save_state()
        Scene scene(GetParam());
        Motion motion(scene);
        for (int i = 0; i < 12; ++i) {
            motion.move(i);
            step(scene);
        }
        if (moves_on) {
            motion.move(12);
            scene.remove(motion.bodies()[20]);
            motion.forget(20);
        }
        const std::vector<BodyId> bodies = motion.bodies();
        const std::vector<std::byte> state = scene.save_state();
        const auto shapes = scene.shapes();
        EXPECT_EQ(shapes.size(), 3u);
        std::vector<Told> expected;
        const auto go_on = [&](Scene& other, Motion& own) {
            std::vector<Told> told;
            for (int i = moves_on ? 13 : 12; i < 40; ++i) {
                told.push_back(step(other));
                own.move(i);
            }
            return told;
        };
        expected = go_on(scene, motion);
        std::size_t fresh = 0, touches = 0;
        for (const Told& told : expected) {
            fresh += told.fresh;
            touches += told.begun;
        }
        EXPECT_GT(fresh, 0u);
        EXPECT_GT(touches, 0u);
        const bool keeps_rays = GetParam().paper.displacement_threshold.has_value();
        EXPECT_TRUE(!keeps_rays || expected.front().walks > 0);
        {
            Motion again(scene, bodies); // the same scene, gone back
            scene.load_state(state, shapes);
            EXPECT_EQ(scene.body_count(), moves_on ? 39u : 40u);
            EXPECT_EQ(scene.user_data(bodies[6]), 42u);
            EXPECT_TRUE(scene.is_static(bodies[4]));
            EXPECT_TRUE(scene.is_sensor(bodies[5]));
            EXPECT_TRUE(scene.lost_contacts().empty());
            EXPECT_TRUE(scene.begun().empty());
            EXPECT_EQ(go_on(scene, again), expected);
        }
        {
            Scene other(GetParam()); // another one, which had others
            const BodyId gone = other.add(shapes[0]);
            other.find_contacts();
            other.load_state(state, shapes);
            EXPECT_TRUE(other.has(gone)) << "slot 0, first generation: an id of the state now";
            EXPECT_EQ(other.save_state().size(), state.size());
            other.load_state(other.save_state(), other.shapes());
            Motion again(other, bodies);
            EXPECT_EQ(go_on(other, again), expected);
        }
    }
}

Settings with(Method method, bool speculative, std::uint32_t most = 0, Direction direction = Direction::reprojected) {
    Settings settings;
    settings.method = method;
    settings.speculative = speculative ? Speculative::on : Speculative::off;
    settings.max_contacts_per_pair = most;
    settings.direction = direction;
    return settings;
}
/// Pairs are seldom tested in full, so that contacts depend on what is kept.
Settings following(Method method, bool speculative, const char* devices) {
    Settings settings = with(method, speculative);
    settings.paper.displacement_threshold = 1;
    settings.execution.devices = devices;
    return settings;
}
INSTANTIATE_TEST_SUITE_P(
    Methods, SavedState,
    testing::Values(with(Method::certified, true), with(Method::certified, false, 3), with(Method::standard, false),
                    with(Method::certified, true, 4, Direction::refined), with(Method::iterative, false),
                    with(Method::iterative, true), with(Method::predictive, true), with(Method::predictive, false, 4),
                    following(Method::iterative, false, "cpu"), following(Method::predictive, true, "cpu"),
                    following(Method::iterative, true, "cpu/0,cpu/1"),
                    following(Method::predictive, false, "cpu/0,cpu/1")));

TEST(SavedState, RefusesWhatItDoesNotFit) {
    const auto box = Shape::make(reference::box_mesh({1, 1, 1})), other = Shape::make(reference::box_mesh({1, 1, 2}));
    Scene scene;
    const BodyId a = scene.add(box), b = scene.add(box, {.translation = {1.9, 0, 0}});
    scene.find_contacts();
    const std::vector<std::byte> state = scene.save_state();
    const auto shapes = scene.shapes();
    const auto refused = [&](std::span<const std::byte> bytes, std::vector<std::shared_ptr<const Shape>> given,
                             const char* why) {
        try {
            scene.load_state(bytes, given);
            ADD_FAILURE() << why;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
        }
        EXPECT_TRUE(scene.has(a) && scene.has(b)) << "nothing has changed";
        EXPECT_FALSE(scene.contacts().empty());
    };
    refused({}, shapes, "no state of a scene");
    for (const std::size_t size : {std::size_t{1}, std::size_t{15}, state.size() / 2, state.size() - 1})
        refused(std::span(state).first(size), shapes, size < 16 ? "no state" : "damaged");
    std::vector<std::byte> damaged = state;
    damaged[state.size() / 3] ^= std::byte{1};
    refused(damaged, shapes, "damaged");
    refused(state, {}, "0 are given");
    refused(state, {other}, "shape 0 is another one");
    refused(state, {nullptr}, "shape 0 is another one");
    Settings settings;
    settings.direction = Direction::ray;
    scene.set_settings(settings);
    scene.find_contacts();
    refused(state, shapes, "other settings");
}

TEST(SavedState, ContactsAreChosenAnewByOtherSettings) {
    const auto ring = Shape::make(test::torus(24, 12, 0.5, 0.2, 0));
    Settings few;
    few.max_contacts_per_pair = 4;
    Scene scene;
    scene.add(ring);
    scene.add(ring, {.translation = {0.3, 0, 0.1}});
    const std::size_t all = scene.find_contacts().size();
    ASSERT_GT(all, 4u);
    const auto state = scene.save_state();
    scene.load_state(state, scene.shapes());
    scene.set_settings(few);
    EXPECT_EQ(scene.find_contacts().size(), 4u);
    scene.load_state(scene.save_state(), scene.shapes());
    EXPECT_EQ(scene.find_contacts().size(), 4u);
    scene.set_settings({});
    EXPECT_EQ(scene.find_contacts().size(), all);
    scene.set_settings(few);
    Scene other(few);
    other.load_state(scene.save_state(), scene.shapes());
    EXPECT_EQ(other.find_contacts().size(), 4u) << "it was saved before the step that would choose";
}

// A rollback: the state of an empty scene, and ids that were given after it was saved.
TEST(SavedState, IdsMeanWhatTheyMeantThen) {
    const auto box = Shape::make(reference::box_mesh({1, 1, 1}));
    Scene scene;
    const std::vector<std::byte> none = scene.save_state();
    const BodyId a = scene.add(box);
    const std::vector<std::byte> one = scene.save_state();
    const BodyId b = scene.add(box);
    scene.find_contacts();
    scene.remove(a);
    scene.load_state(one, std::vector<std::shared_ptr<const Shape>>{box});
    EXPECT_TRUE(scene.has(a));
    EXPECT_FALSE(scene.has(b));
    EXPECT_EQ(scene.add(box), b) << "as it went then";
    scene.load_state(none, {});
    EXPECT_EQ(scene.body_count(), 0u);
    EXPECT_EQ(scene.find_contacts().size(), 0u);
    EXPECT_EQ(scene.add(box), a);
}

} // namespace
} // namespace raycontact
