// SPDX-License-Identifier: Apache-2.0
// Which contacts stay where Settings::max_contacts_per_pair or max_contacts ask for fewer
// (docs/conventions.md, Fewer contacts).
#include "property/crowds.h"
#include "property/shapes.h"
#include "reference/meshes.h"
#include "reference/vector.h"

#include <raycontact/manifold.h>
#include <raycontact/scene.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

using Slots = std::pair<BodyId, BodyId>;
Slots pair_of(const Contact& c) {
    return {c.body_a, c.body_b};
}
auto key_of(const Contact& c) {
    return std::tuple(c.body_a, c.body_b, c.key());
}

std::shared_ptr<const Shape> box(double x, double y, double z) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i) mesh.vertices.push_back({(i & 1) * x, (i >> 1 & 1) * y, (i >> 2) * z});
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return Shape::make(prepare_mesh(mesh));
}

// Bodies in a crowd, moved the same way in every scene.
class Crowd {
public:
    explicit Crowd(const Settings& settings) : scene_(settings), random_(7) {
        const auto subjects = closed_subjects();
        for (std::uint32_t i = 0; i < 30; ++i) {
            Pose pose = random_.rotation();
            pose.translation = 1.5 * random_.in_ball();
            ids_.push_back(scene_.add(subjects[i % subjects.size()].shape, pose));
            poses_.push_back(pose);
        }
    }
    std::span<const Contact> step() {
        for (std::size_t i = 0; i < ids_.size(); ++i) {
            poses_[i].translation = poses_[i].translation + 0.01 * random_.in_ball();
            scene_.set_pose(ids_[i], poses_[i]);
        }
        return scene_.find_contacts();
    }
    Scene& scene() { return scene_; }

private:
    Scene scene_;
    Random random_;
    std::vector<BodyId> ids_;
    std::vector<Pose> poses_;
};

std::map<Slots, std::vector<Contact>> by_pair(std::span<const Contact> contacts) {
    std::map<Slots, std::vector<Contact>> pairs;
    for (const Contact& c : contacts) pairs[pair_of(c)].push_back(c);
    return pairs;
}
float deepest(const std::vector<Contact>& contacts) {
    return std::ranges::max_element(contacts, {}, &Contact::depth)->depth;
}

Settings limited(std::uint32_t per_pair, std::uint32_t all = 0) {
    Settings settings;
    settings.max_contacts_per_pair = per_pair;
    settings.max_contacts = all;
    return settings;
}

class ReductionOf : public testing::TestWithParam<Direction> {};

// Of `refined` only those that stay are refined, and as many as it takes to know the deepest.
TEST_P(ReductionOf, KeepsSomeOfAllAndTheDeepestOfEachPair) {
    for (const std::uint32_t most : {1u, 2u, 4u, 8u, 1000u}) {
        Settings all_kept, few_kept = limited(most);
        all_kept.direction = few_kept.direction = GetParam();
        Crowd full(all_kept), fewer(few_kept);
        std::size_t left_out = 0;
        for (int step = 0; step < 10; ++step) {
            const auto all = full.step(), kept = fewer.step();
            EXPECT_TRUE(std::ranges::is_sorted(kept, {}, key_of));
            for (const Contact& c : kept) {
                const auto found = std::ranges::lower_bound(all, key_of(c), {}, key_of);
                ASSERT_TRUE(found != all.end() && same_bits({&*found, 1}, {&c, 1}));
            }
            const auto pairs = by_pair(all), kept_pairs = by_pair(kept);
            ASSERT_EQ(pairs.size(), kept_pairs.size());
            for (const auto& [pair, own] : kept_pairs) {
                EXPECT_LE(own.size(), most);
                // One that was there counts as a tenth deeper.
                EXPECT_GE(deepest(own), deepest(pairs.at(pair)) / (step == 0 ? 1 : 1.1001f));
            }
            const StepStats& stats = fewer.scene().stats();
            EXPECT_EQ(stats.contacts, kept.size());
            EXPECT_EQ(stats.contacts + stats.contacts_reduced, all.size());
            EXPECT_EQ(stats.depth_max, full.scene().stats().depth_max);
            EXPECT_EQ(full.scene().stats().contacts_reduced, 0u);
            left_out += stats.contacts_reduced;
        }
        EXPECT_GT(left_out, 1000u) << most;
    }
}

INSTANTIATE_TEST_SUITE_P(Directions, ReductionOf,
                         testing::Values(Direction::reprojected, Direction::refined, Direction::ray),
                         [](const auto& of) { return std::string(to_string(of.param)); });

// What a scene has forgotten neither stays nor is any longer known: it is as in a scene that begins there.
TEST(Reduction, OfForgottenContactsPrefersNone) {
    for (const Direction direction : {Direction::reprojected, Direction::refined}) {
        Settings settings = limited(4);
        settings.direction = direction;
        Crowd crowd(settings);
        for (int step = 0; step < 6; ++step) {
            crowd.step();
            crowd.scene().forget_contacts();
            EXPECT_TRUE(crowd.scene().contacts().empty());
            const auto found = crowd.scene().find_contacts(); // though nothing moved
            ASSERT_FALSE(found.empty());
            EXPECT_TRUE(std::ranges::all_of(found, &Contact::is_new));
            Scene fresh(settings);
            for (const BodyId body : crowd.scene().bodies())
                fresh.add(crowd.scene().shape(body).shared_from_this(), crowd.scene().pose(body));
            EXPECT_TRUE(same_bits(found, fresh.find_contacts()));
        }
    }
}

// Step after step: what was there in the step before has an advantage, so a difference would go on.
TEST(Reduction, IsTheSameOnEveryWayThroughTheLibrary) {
    for (const Settings& limits : {limited(4), limited(0, 150), limited(6, 100)}) {
        const auto hash_of = [&](const auto& change) {
            Settings settings = limits;
            change(settings);
            Crowd crowd(settings);
            ContactHash hash;
            for (std::uint32_t step = 0; step < 12; ++step) hash.add(step, crowd.step());
            return hash.hex();
        };
        const std::string hash = hash_of([](Settings&) {});
        EXPECT_EQ(hash_of([](Settings& s) { s.execution.threads = 1; }), hash);
        EXPECT_EQ(hash_of([](Settings& s) { s.execution.threads = 5; }), hash);
        EXPECT_EQ(hash_of([](Settings& s) { s.method = Method::standard; }), hash);
        EXPECT_EQ(hash_of([](Settings& s) { s.paper.caster = Caster::basic; }), hash);
        EXPECT_EQ(hash_of([](Settings& s) { s.execution.devices = "cpu/0,cpu/1"; }), hash);
        EXPECT_NE(hash_of([](Settings& s) { s.max_contacts_per_pair = s.max_contacts = 0; }), hash);
    }
}

TEST(Reduction, ABudgetLeavesEachPairItsDeepest) {
    for (const std::uint32_t budget : {1u, 60u, 200u, 100000u}) {
        Crowd full({}), unlimited(limited(1000)), fewer(limited(0, budget));
        for (int step = 0; step < 5; ++step) {
            const auto pairs = by_pair(full.step());
            const auto chosen_pairs = by_pair(unlimited.step());
            const std::size_t chosen = unlimited.scene().contacts().size();
            const auto kept = fewer.step();
            EXPECT_EQ(kept.size(), std::max(pairs.size(), std::min<std::size_t>(chosen, budget)));
            const auto kept_pairs = by_pair(kept);
            ASSERT_EQ(kept_pairs.size(), pairs.size());
            for (const auto& [pair, own] : kept_pairs)
                EXPECT_GE(deepest(own), deepest(pairs.at(pair)) / (step == 0 ? 1 : 1.1001f));
            // No pair gets another point while one that has fewer goes without its next.
            std::size_t most = 0, least = chosen;
            for (const auto& [pair, own] : kept_pairs) {
                most = std::max(most, own.size());
                if (own.size() < chosen_pairs.at(pair).size()) least = std::min(least, own.size());
            }
            EXPECT_LE(most, least + 1);
        }
    }
}

// Equal boxes, one on the other and turned: the rule finds vertices and edges about each corner.
TEST(Reduction, ABoxOnABoxHasFour) {
    const auto shape = box(1, 1, 1);
    std::size_t most = 0;
    for (const double angle : {0.0, 1e-4, 1e-3, 0.01, 0.2}) {
        Settings settings = limited(8);
        Scene full, fewer(settings);
        std::array<std::size_t, 2> counts{};
        for (Scene* scene : {&full, &fewer}) {
            scene->add(shape);
            Pose pose = small_rotation({0, 0, 1}, angle);
            pose.translation = {0.003, 0.002, 0.998};
            scene->add(shape, pose);
            counts[scene == &fewer] = scene->find_contacts().size();
        }
        most = std::max(most, counts[0]);
        EXPECT_EQ(counts[1], 4u) << angle << " of " << counts[0];
        Vec3 low{1, 1, 1}, high{0, 0, 0};
        for (const Contact& c : fewer.contacts()) {
            EXPECT_GT(c.normal.z, 0.99f);
            low = {std::min(low.x, c.point().x), std::min(low.y, c.point().y), 0};
            high = {std::max(high.x, c.point().x), std::max(high.y, c.point().y), 0};
        }
        EXPECT_LT(low.x + low.y, angle == 0.2 ? 0.4 : 0.03) << angle;
        EXPECT_GT(high.x + high.y, angle == 0.2 ? 1.6 : 1.97) << angle;
    }
    EXPECT_GE(most, 6u);
}

// A plate on a floor: most points that were there stay, so that a solver can start warm.
TEST(Reduction, ABodyAtRestKeepsItsPoints) {
    Random random(3);
    Scene scene(limited(4));
    scene.add(box(10, 10, 1));
    Pose pose;
    std::size_t changed = 0, steps = 0;
    const auto plate = [] {
        Mesh mesh; // its lower side is a grid
        constexpr int n = 9;
        for (int side = 0; side < 2; ++side)
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) mesh.vertices.push_back({i / 8.0, j / 8.0, 0.1 * side});
        const auto at = [](int side, int i, int j) { return static_cast<std::uint32_t>((side * n + i) * n + j); };
        for (int i = 0; i + 1 < n; ++i)
            for (int j = 0; j + 1 < n; ++j) {
                mesh.triangles.push_back({at(0, i, j), at(0, i, j + 1), at(0, i + 1, j)});
                mesh.triangles.push_back({at(0, i + 1, j), at(0, i, j + 1), at(0, i + 1, j + 1)});
                mesh.triangles.push_back({at(1, i, j), at(1, i + 1, j), at(1, i, j + 1)});
                mesh.triangles.push_back({at(1, i + 1, j), at(1, i + 1, j + 1), at(1, i, j + 1)});
            }
        for (int k = 0; k + 1 < n; ++k) {
            const auto wall = [&](int i0, int j0, int i1, int j1) {
                mesh.triangles.push_back({at(0, i0, j0), at(0, i1, j1), at(1, i0, j0)});
                mesh.triangles.push_back({at(1, i0, j0), at(0, i1, j1), at(1, i1, j1)});
            };
            wall(k, 0, k + 1, 0);
            wall(k + 1, n - 1, k, n - 1);
            wall(0, k + 1, 0, k);
            wall(n - 1, k, n - 1, k + 1);
        }
        return Shape::make(prepare_mesh(mesh));
    }();
    const BodyId body = scene.add(plate, pose);
    for (int step = 0; step < 200; ++step) {
        // It rocks by less than it is deep: now one corner is deepest, now another.
        const Pose rocked = small_rotation(random.direction(), 1e-5 * random.uniform());
        pose.rotation = rocked.rotation;
        pose.translation = {4, 4, 0.9985};
        scene.set_pose(body, pose);
        const auto contacts = scene.find_contacts();
        ASSERT_EQ(contacts.size(), 4u);
        if (step == 0) continue;
        changed += scene.stats().contacts_new;
        ++steps;
    }
    EXPECT_LT(double(changed) / double(steps), 1.0); // of four
}

// One body of many moves: some ways through the library ask about its pairs alone, others about all. Choosing again
// among the same points may come to others, as points that were there have an advantage.
TEST(Reduction, APairThatHasWhatItHadKeepsItsChoice) {
    Random random(3);
    const auto slab = [&] {
        Mesh mesh = grid_box_mesh(8);
        for (Vec3& v : mesh.vertices) v = {v.x - 0.5, v.y - 0.5, 0.3 * (v.z - 0.5) + random.uniform(-0.01, 0.01)};
        return Shape::make(prepare_mesh(mesh));
    };
    std::vector<std::shared_ptr<const Shape>> slabs;
    for (int i = 0; i < 20; ++i) slabs.push_back(slab());
    struct Stack {
        std::shared_ptr<const Shape> below, above;
        Pose lower, upper;
    };
    std::vector<Stack> stacks;
    for (int i = 0; i < 1000; ++i) {
        Stack& stack = stacks.emplace_back();
        stack.below = slabs[random.below(20)];
        stack.above = slabs[random.below(20)];
        stack.lower.translation = {3.0 * i, 0, 0};
        stack.upper = small_rotation({0, 0, 1}, random.uniform());
        stack.upper.translation = {3.0 * i + random.uniform(0, 0.2), random.uniform(0, 0.2), 0.296};
    }
    const auto hash_of = [&](const auto& change) {
        Settings settings = limited(3);
        settings.features = Features::vertices;
        change(settings);
        Scene scene(settings);
        BodyId moving;
        for (const Stack& stack : stacks) {
            scene.add(stack.below, stack.lower);
            moving = scene.add(stack.above, stack.upper);
        }
        ContactHash hash;
        for (std::uint32_t step = 0; step < 4; ++step) {
            Pose pose = stacks.back().upper;
            pose.translation.y += 0.001 * step;
            scene.set_pose(moving, pose);
            hash.add(step, scene.find_contacts());
            EXPECT_GT(scene.stats().contacts_reduced, 1000u);
            EXPECT_LE(scene.stats().contacts_new, step == 0 ? 3000u : 3u);
        }
        return hash.hex();
    };
    const std::string hash = hash_of([](Settings&) {});
    EXPECT_EQ(hash_of([](Settings& s) { s.method = Method::standard; }), hash);
    EXPECT_EQ(hash_of([](Settings& s) { s.execution.devices = "cpu/0,cpu/1"; }), hash);
}

TEST(Reduction, PredictionsAreOfVerticesWithoutAnyContact) {
    Settings settings;
    settings.method = Method::predictive;
    Settings few = settings;
    few.max_contacts_per_pair = 1;
    Crowd full(settings), fewer(few);
    std::size_t count = 0;
    for (int step = 0; step < 6; ++step) {
        full.step();
        fewer.step();
        const auto all = full.scene().predictions(), own = fewer.scene().predictions();
        ASSERT_EQ(all.size(), own.size());
        count += all.size();
    }
    EXPECT_GT(count, 0u);
}

} // namespace
