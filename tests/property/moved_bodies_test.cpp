// SPDX-License-Identifier: Apache-2.0
// A scene asks each step for the bodies that moved alone. Whatever is done to it in between, each step finds what a
// scene finds that is new, has the same bodies and knows nothing of earlier steps.
#include "property/crowds.h"
#include "property/shapes.h"
#include "reference/meshes.h"
#include "reference/vector.h"

#include <raycontact/scene.h>

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <set>

namespace raycontact::reference {
namespace {

/// What a body is, beside its slot.
struct Told {
    std::shared_ptr<const Shape> shape;
    Pose pose;
    std::optional<Pose> next;
    std::optional<double> margin;
    std::uint32_t groups = 1, mask = 0xffffffffu;
};

class Twins {
public:
    explicit Twins(const Settings& settings) : settings_(settings), scene_(settings) {}

    std::size_t size() const { return told_.size(); }
    BodyId any(Random& random) const {
        return std::next(told_.begin(), long(random.below(std::uint32_t(told_.size()))))->first;
    }

    const Pose& pose(BodyId body) const { return told_.at(body).pose; }

    void add(const std::shared_ptr<const Shape>& shape, const Pose& pose) {
        told_[scene_.add(shape, pose)] = {shape, pose, {}, {}};
    }
    void remove(BodyId body) {
        scene_.remove(body);
        told_.erase(body);
    }
    void move(BodyId body, const Pose& pose) {
        scene_.set_pose(body, pose);
        told_[body].pose = pose;
    }
    void filter(BodyId body, std::uint32_t groups, std::uint32_t mask) {
        scene_.set_filter(body, groups, mask);
        told_[body].groups = groups;
        told_[body].mask = mask;
    }
    void expect(BodyId body, const Pose& pose) {
        scene_.set_next_pose(body, pose);
        told_[body].next = pose;
    }
    void set_margin(BodyId body, double margin) {
        scene_.set_speculative_margin(body, margin);
        told_[body].margin = margin;
    }
    void set_settings(const Settings& settings) {
        scene_.set_settings(settings);
        settings_ = settings;
    }

    /// Returns the number of contacts. given: find_contacts(pairs) instead, of every second pair.
    std::size_t step(bool given) {
        Scene fresh(settings_);
        std::map<BodyId, BodyId> twin; // in the order of slots, so that pairs are the same way round
        for (auto& [body, told] : told_) {
            const BodyId own = twin[body] = fresh.add(told.shape, told.pose);
            fresh.set_filter(own, told.groups, told.mask);
            if (told.margin) fresh.set_speculative_margin(own, told.margin);
        }
        if (settings_.is_speculative()) {
            // What it expects follows from the last step's poses.
            for (auto& [body, told] : told_) {
                const auto last = last_.find(body);
                if (last != last_.end()) fresh.set_pose(twin[body], last->second);
            }
            fresh.find_contacts(std::span<const Pair>{});
            for (auto& [body, told] : told_) {
                fresh.set_pose(twin[body], told.pose);
                if (last_.count(body) == 0 && !told.next) fresh.set_next_pose(twin[body], told.pose);
                if (told.next) fresh.set_next_pose(twin[body], *std::exchange(told.next, std::nullopt));
            }
        }
        last_.clear();
        for (const auto& [body, told] : told_) last_[body] = told.pose;
        std::span<const Contact> found, expected;
        if (given) {
            fresh.find_contacts();
            std::vector<Pair> some, others;
            std::map<BodyId, BodyId> back;
            for (const auto& [body, own] : twin) back[own] = body;
            for (std::size_t i = 0; i < fresh.pairs().size(); i += 2) {
                const auto [a, b] = fresh.pairs()[i];
                others.push_back({a, b});
                some.push_back({back[a], back[b]});
            }
            if (settings_.is_speculative()) return scene_.find_contacts(some).size(); // the fresh one has made its step
            expected = fresh.find_contacts(others);
            found = scene_.find_contacts(some);
        } else {
            expected = fresh.find_contacts();
            found = scene_.find_contacts();
        }
        EXPECT_EQ(scene_.pairs().size(), fresh.pairs().size());
        for (std::size_t i = 0; i < std::min(scene_.pairs().size(), fresh.pairs().size()); ++i) {
            EXPECT_EQ(twin.at(scene_.pairs()[i].first), fresh.pairs()[i].first);
            EXPECT_EQ(twin.at(scene_.pairs()[i].second), fresh.pairs()[i].second);
        }
        EXPECT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < std::min(found.size(), expected.size()); ++i) {
            const Contact &c = found[i], &e = expected[i];
            EXPECT_EQ(twin.at(c.body_a), e.body_a);
            EXPECT_EQ(twin.at(c.body_b), e.body_b);
            EXPECT_EQ(c.key(), e.key());
            EXPECT_EQ(c.depth, e.depth);
            EXPECT_EQ(c.point(), e.point());
        }
        return found.size();
    }

private:
    Settings settings_;
    Scene scene_;
    std::map<BodyId, Told> told_;
    std::map<BodyId, Pose> last_;
};

TEST(moved_bodies, a_step_finds_what_a_new_scene_finds) {
    std::size_t contacts = 0;
    for (const Method method : {Method::certified, Method::standard})
        for (const std::optional<double> margin : {std::optional<double>(), std::optional(0.02)})
            for (const Kind kind : {Kind::concave, Kind::open, Kind::sizes}) {
                const auto& shapes = crowd_shapes(kind, 1);
                Settings settings;
                settings.method = method;
                settings.speculative = margin.has_value() ? Speculative::on : Speculative::off;
                settings.speculative_margin = margin;
                settings.execution.threads = method == Method::standard ? 2 : 1;
                Twins twins(settings);
                Random random(static_cast<unsigned>(kind) + 7);
                const auto anywhere = [&] {
                    Pose pose = random.rotation();
                    pose.translation = 2.2 * random.in_ball();
                    return pose;
                };
                const auto add = [&] { twins.add(shapes[random.below(std::uint32_t(shapes.size()))], anywhere()); };
                for (int i = 0; i < 24; ++i) add();
                for (int step = 0; step < 65 && !testing::Test::HasFailure(); ++step) {
                    const int moves = step % 7 == 6 ? 0 : step % 7 == 5 ? 40 : 1 + int(random.below(3));
                    for (int i = 0; i < moves; ++i) {
                        const BodyId body = twins.any(random);
                        Pose a_little = twins.pose(body);
                        a_little.translation = a_little.translation + 0.004 * random.in_ball();
                        twins.move(body, i % 2 == 0 && step % 13 > 2 ? a_little : anywhere());
                    }
                    if (random.below(4) == 0) twins.remove(twins.any(random));
                    if (random.below(3) == 0) add();
                    while (step % 13 == 12 && twins.size() > 3) twins.remove(twins.any(random)); // shapes move up
                    while (step % 13 == 1 && twins.size() < 24) add();
                    if (random.below(8) == 0)
                        twins.filter(twins.any(random), 1u << random.below(2), std::uint32_t(random.below(4)));
                    if (margin && random.below(3) == 0) twins.expect(twins.any(random), anywhere());
                    if (margin && random.below(5) == 0) twins.set_margin(twins.any(random), random.uniform(0, 0.1));
                    if (random.below(9) == 0) {
                        settings.method = settings.method == Method::standard ? Method::certified : Method::standard;
                        twins.set_settings(settings);
                    }
                    contacts += twins.step(random.below(5) == 0);
                }
            }
    EXPECT_GT(contacts, 20000u);
}

// Given pairs in any order; nothing is cast, the contacts stay, and who holds the last ones still reads that they are
// new.
TEST(moved_bodies, a_step_in_which_nothing_moved_has_the_last_contacts) {
    Settings settings;
    settings.method = Method::standard;
    settings.features = Features::vertices;
    Scene scene(settings);
    const auto& shapes = crowd_shapes(Kind::concave, 1);
    std::vector<BodyId> bodies;
    for (int i = 0; i < 3; ++i) {
        Pose pose;
        pose.translation.x = 0.3 * i;
        bodies.push_back(scene.add(shapes[0], pose));
    }
    const std::vector<Pair> pairs{{bodies[2], bodies[1]}, {bodies[0], bodies[1]}, {bodies[1], bodies[0]}};
    const auto held = [&] {
        scene.find_contacts(pairs);
        return scene.shared_contacts();
    };
    const auto first = held(), second = held();
    EXPECT_EQ(scene.stats().details.rays_cast, 0u);
    EXPECT_EQ(scene.stats().contacts_new, 0u);
    EXPECT_EQ(scene.stats().contacts, first->size());
    ASSERT_GT(first->size(), 0u);
    ASSERT_EQ(second->size(), first->size());
    for (std::size_t i = 0; i < first->size(); ++i) {
        EXPECT_TRUE((*first)[i].is_new);
        EXPECT_FALSE((*second)[i].is_new);
        EXPECT_EQ((*first)[i].depth, (*second)[i].depth);
    }
    EXPECT_EQ(held(), second) << "nothing is copied where nothing changes";
    scene.set_pose(bodies[2], {});
    held();
    EXPECT_GT(scene.stats().details.rays_cast, 0u);
}

// Of a pair that was open before, too. Two cubes, edge to edge, 3 % of a side apart.
TEST(moved_bodies, a_margin_that_changes_holds_from_the_next_step) {
    const auto cube = Shape::make(prepare_mesh(box_mesh({0.5, 0.5, 0.5})));
    const Pose here = pose_from_quaternion({}, std::cos(std::numbers::pi / 8), 0, 0, std::sin(std::numbers::pi / 8));
    Pose there = here;
    there.translation = {1.03 / std::sqrt(2.0), 1.03 / std::sqrt(2.0), 0};
    for (const Method method : {Method::certified, Method::standard, Method::iterative, Method::predictive})
        for (const bool own : {false, true}) {
            Settings settings;
            settings.method = method;
            settings.speculative = Speculative::on;
            settings.speculative_margin = 0.001;
            Scene scene(settings);
            const BodyId body = scene.add(cube, here);
            scene.add(cube, there);
            EXPECT_EQ(scene.find_contacts().size(), 0u);
            ASSERT_EQ(scene.pairs().size(), 1u);
            if (own) {
                scene.set_speculative_margin(body, 0.1);
            } else {
                settings.speculative_margin = 0.1;
                scene.set_settings(settings);
            }
            EXPECT_GT(scene.find_contacts().size(), 0u) << to_string(method) << own;
        }
}

} // namespace
} // namespace raycontact::reference
