// SPDX-License-Identifier: Apache-2.0
// Slots are given again, ids never, and a body has nothing of the one that had its slot before.
#include "property/shapes.h"
#include "reference/meshes.h"

#include <raycontact/error.h>

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <string>

namespace raycontact::reference {
namespace {

constexpr Method methods[] = {Method::standard, Method::iterative, Method::predictive, Method::certified};

Settings settings_of(Method method, Features features = Features::edges) {
    Settings settings;
    settings.method = method;
    settings.features = features;
    settings.execution.threads = 1;
    return settings;
}

std::shared_ptr<const Shape> box(const Vec3& half) {
    return Shape::make(box_mesh(half));
}

Pose at(double x, double y, double z) {
    Pose pose;
    pose.translation = {x, y, z};
    return pose;
}

std::string message_of(const std::function<void()>& call) {
    try {
        call();
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

TEST(body_ids, the_lowest_slot_is_given_again) {
    Scene scene;
    const auto shape = box({1, 1, 1});
    for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(scene.add(shape), BodyId{i});
    scene.remove({2}); // no step has seen it
    EXPECT_EQ(scene.add(shape), (BodyId{2, 1}));
    scene.find_contacts();
    scene.remove({0});
    scene.remove({3});
    EXPECT_EQ(scene.add(shape), BodyId{4}); // the next step must see the others empty
    scene.find_contacts();
    EXPECT_EQ(scene.add(shape), (BodyId{0, 1}));
    EXPECT_EQ(scene.add(shape), (BodyId{3, 1}));
    EXPECT_EQ(scene.body_count(), 5u);
    EXPECT_TRUE(scene.has({2, 1}));
    for (const BodyId gone : {BodyId{2}, BodyId{5}, BodyId{}}) EXPECT_FALSE(scene.has(gone));
}

TEST(body_ids, a_stale_id_is_refused_by_name) {
    Scene scene;
    const auto shape = box({1, 1, 1});
    scene.add(shape);
    const BodyId other = scene.add(shape, at(1, 0, 0));
    const BodyId stale = scene.add(shape, at(0, 1, 0));
    const std::vector<Pair> good{{BodyId{0}, other}}, bad{{BodyId{0}, other}, {stale, BodyId{0}}};
    scene.find_contacts(bad);
    scene.remove(stale);
    for (const bool taken : {false, true}) {
        if (taken) {
            scene.find_contacts(good);
            ASSERT_EQ(scene.add(shape), (BodyId{2, 1}));
        }
        const std::pair<std::string, std::function<void()>> calls[] = {
            {"Scene::remove", [&] { scene.remove(stale); }},
            {"Scene::set_pose", [&] { scene.set_pose(stale, {}); }},
            {"Scene::pose", [&] { scene.pose(stale); }},
            {"Scene::shape", [&] { scene.shape(stale); }},
            {"Scene::find_contacts, pair 1", [&] { scene.find_contacts(bad); }},
            {"Scene::set_poses, place 1",
             [&] {
                 scene.set_poses(std::vector{other, stale}, std::vector<Pose>(2));
             }},
            {"Scene::set_next_pose", [&] { scene.set_next_pose(stale, {}); }},
            {"Scene::set_speculative_margin", [&] { scene.set_speculative_margin(stale, 1); }},
            {"Scene::set_user_data", [&] { scene.set_user_data(stale, 1); }},
            {"Scene::user_data", [&] { (void)scene.user_data(stale); }},
            {"Scene::set_filter", [&] { scene.set_filter(stale, 1, 1); }},
            {"Scene::contacts", [&] { (void)scene.contacts(other, stale); }},
            {"Scene::contacts", [&] { (void)scene.contacts(stale, other); }},
            {"Scene::distance", [&] { (void)scene.distance(other, stale); }},
            {"Scene::distance", [&] { (void)scene.distance(stale, other); }},
        };
        for (const auto& [name, call] : calls) {
            EXPECT_EQ(message_of(call), name + ": body 2 (generation 0) was removed"
                                            + (taken ? ", and its slot has body 2 (generation 1) now" : "")
                                            + "; forget its id, or add it again and use the id that add() gives");
        }
    }
    EXPECT_EQ(message_of([&] { scene.pose({17}); }),
              "Scene::pose: body 17 (generation 0) is not in the scene; add() gives the ids that are");
    EXPECT_EQ(message_of([&] {
                  scene.pose(BodyId{2, 7});
              }),
              "Scene::pose: body 2 (generation 7) is not in the scene; add() gives the ids that are");
    EXPECT_EQ(message_of([&] { scene.pose({}); }), "Scene::pose: this id is empty; add() gives those of bodies");
    EXPECT_EQ(scene.pose(BodyId{2, 1}), Pose{});
    EXPECT_EQ(scene.pose(other), at(1, 0, 0));
    EXPECT_EQ(message_of([&] { scene.add(nullptr); }), "body 3: the shape is null");
    EXPECT_EQ(scene.body_count(), 3u);
}

// A body in the very place of another: at once in another slot, and after a step in its own.
TEST(body_ids, contacts_of_a_successor_are_new) {
    const auto shape = box({1, 1, 1});
    for (const Method method : methods) {
        for (const bool given : {false, true}) {
            Scene scene(settings_of(method));
            const BodyId ground = scene.add(shape);
            BodyId body = scene.add(shape, at(0.1, 0.2, 1.9));
            const auto step = [&] {
                const std::vector<Pair> pairs{{ground, body}};
                return given ? scene.find_contacts(pairs) : scene.find_contacts();
            };
            const auto count = step().size();
            ASSERT_GT(count, 0u);
            step();
            EXPECT_EQ(scene.stats().contacts_new, 0u);

            scene.remove(body);
            body = scene.add(shape, at(0.1, 0.2, 1.9));
            EXPECT_EQ(body, BodyId{2});
            EXPECT_EQ(step().size(), count) << to_string(method);
            EXPECT_EQ(scene.stats().contacts_new, count) << to_string(method);
            EXPECT_EQ(scene.stats().contacts_lost, count) << to_string(method);
            for (const LostContact& lost : scene.lost_contacts()) EXPECT_EQ(lost.body_b, BodyId{1});

            scene.remove(body);
            scene.find_contacts(std::span<const Pair>{}); // frees slot 2
            body = scene.add(shape, at(0.1, 0.2, 1.9));
            EXPECT_EQ(body, (BodyId{1, 1}));
            EXPECT_EQ(step().size(), count) << to_string(method);
            EXPECT_EQ(scene.stats().contacts_new, count) << to_string(method);
            EXPECT_EQ(scene.stats().contacts_lost, 0u) << to_string(method);
            ASSERT_EQ(scene.pairs().size(), 1u);
            EXPECT_EQ(scene.pairs()[0], Pair(ground, body));
            EXPECT_EQ(scene.contacts()[0].body_b, body);
        }
    }
}

// A pair may be given in terms of ids in any order, and comes back by slots.
TEST(body_ids, pairs_are_sorted_by_slots) {
    Scene scene(settings_of(Method::certified));
    const auto shape = box({1, 1, 1});
    for (int i = 0; i < 4; ++i) scene.add(shape, at(0.3 * i, 0.2 * i, 0.1 * i));
    scene.remove({0});
    scene.remove({2});
    const BodyId zero = scene.add(shape), two = scene.add(shape, at(0.6, 0.4, 0.2));
    ASSERT_EQ(two, (BodyId{2, 1}));
    const std::vector<Pair> sorted{{zero, BodyId{1}}, {zero, BodyId{3}}, {BodyId{1}, two}, {two, BodyId{3}}};
    const std::vector<Pair> mixed{
        {BodyId{3}, two}, {two, BodyId{1}}, {BodyId{3}, zero}, {BodyId{1}, zero}, {zero, BodyId{1}}};
    scene.find_contacts(mixed);
    EXPECT_TRUE(std::equal(sorted.begin(), sorted.end(), scene.pairs().begin(), scene.pairs().end()));
    const Contact* last = nullptr;
    for (const Contact& c : scene.contacts()) {
        EXPECT_LT(c.body_a, c.body_b);
        if (last) {
            EXPECT_LE(std::pair(last->body_a, last->body_b), std::pair(c.body_a, c.body_b));
        }
        last = &c;
    }
    ASSERT_TRUE(last);
    EXPECT_TRUE(
        same_bits(std::vector<Contact>(scene.contacts().begin(), scene.contacts().end()), scene.find_contacts(sorted)));
}

// Steps of `standard` ask for no motion. A large body that then stands where a small one stood, to the bit, is no
// small one that stood still: turned about, a plate reaches its far end.
TEST(body_ids, motion_is_not_inherited_through_another_method) {
    const auto small = box({0.1, 0.1, 0.1}), rod = box({2.5, 0.05, 0.1});
    Scene scene(settings_of(Method::certified, Features::vertices)),
        standard(settings_of(Method::standard, Features::vertices));
    const auto plate = box({0.1, 3, 0.5});
    for (Scene* s : {&scene, &standard}) s->add(plate);
    const BodyId before = scene.add(small, at(0, 0, 0.55));
    scene.find_contacts(std::vector<Pair>{{BodyId{0}, before}});
    scene.find_contacts(std::vector<Pair>{{BodyId{0}, before}});
    scene.remove(before);
    scene.set_settings(settings_of(Method::standard, Features::vertices));
    scene.find_contacts();
    scene.set_settings(settings_of(Method::certified, Features::vertices));
    standard.remove(standard.add(small)); // the same ids in both
    const std::vector<Pair> pair{{BodyId{0}, scene.add(rod, at(0, 0, 0.55))}},
        plain{{BodyId{0}, standard.add(rod, at(0, 0, 0.55))}};
    ASSERT_EQ(pair[0].second, (BodyId{1, 1}));
    std::uint64_t contacts = 0, without = 0;
    for (int i = 0; i < 400; ++i) {
        const double half = 0.004 * i;
        const Pose turned = pose_from_quaternion({0, 0, 0}, std::cos(half), 0, 0, std::sin(half));
        scene.set_pose({0}, turned);
        standard.set_pose({0}, turned);
        const std::span<const Contact> expected = standard.find_contacts(plain), found = scene.find_contacts(pair);
        ASSERT_TRUE(same_bits(expected, found)) << "step " << i;
        contacts += found.size();
        without += found.empty();
    }
    EXPECT_GT(contacts, 0u);
    EXPECT_GT(without, 0u);
}

// As for contactPairTest: two bodies for one step.
TEST(body_ids, slots_stay_as_few_as_were_needed_at_once) {
    const auto shape = box({1, 1, 1});
    for (const bool steps : {false, true}) {
        Scene scene(settings_of(Method::standard));
        scene.add(shape);
        const int calls = steps ? 100000 : 1000000;
        for (int i = 0; i < calls; ++i) {
            const BodyId a = scene.add(shape), b = scene.add(shape, at(0.1, 0.2, 1.9));
            ASSERT_LT(a.slot, 5u);
            ASSERT_LT(b.slot, 5u);
            if (steps) {
                ASSERT_FALSE(scene.find_contacts(std::vector<Pair>{{a, b}}).empty());
            }
            scene.remove(a);
            scene.remove(b);
        }
        EXPECT_EQ(scene.body_count(), 1u);
    }
}

} // namespace
} // namespace raycontact::reference
