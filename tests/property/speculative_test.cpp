// SPDX-License-Identifier: Apache-2.0
// Speculative contacts against the reference; what they leave as it is; what a body is expected to do.
#include "property/speculative_reference.h"

#include <raycontact/error.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

Settings speculative_settings() {
    Settings settings;
    settings.execution.devices = "cpu";
    settings.speculative = true;
    settings.features = Features::vertices;
    return settings;
}

// A move by up to `far` metres and a turn by up to some 0.4 times as much.
Pose moved(const Pose& pose, double far, Random& random) {
    const Vec3 axis = 0.2 * far * random.in_ball();
    const Pose turn = pose_from_quaternion({}, 1, axis.x, axis.y, axis.z);
    Pose next = pose;
    for (std::size_t j = 0; j < 3; ++j) {
        const Vec3 column = rotate(turn, {pose.rotation[j], pose.rotation[3 + j], pose.rotation[6 + j]});
        next.rotation[j] = column.x, next.rotation[3 + j] = column.y, next.rotation[6 + j] = column.z;
    }
    next.translation = pose.translation + far * random.in_ball();
    return next;
}

struct Flight {
    Placement now;
    Pose next_a, next_b;
};

std::vector<Flight> random_flights(std::size_t count, std::uint64_t seed, double far) {
    Random random(seed);
    auto subjects = pointers(closed_subjects());
    for (const Subject* open : pointers(open_subjects())) subjects.push_back(open);
    std::vector<Flight> flights;
    for (std::size_t i = 0; i < count; ++i) {
        Flight flight;
        flight.now = random_placement(subjects, random);
        flight.next_a = moved(flight.now.pose_a, far, random);
        flight.next_b = moved(flight.now.pose_b, far, random);
        flights.push_back(flight);
    }
    return flights;
}

std::vector<Placement> beginnings(const std::vector<Flight>& flights) {
    std::vector<Placement> placements(flights.size());
    std::ranges::transform(flights, placements.begin(), &Flight::now);
    return placements;
}

View view(const Flight& f, bool of_b) {
    const Placement& p = f.now;
    return of_b ? View{*p.b, *p.a, p.pose_b, f.next_b, p.pose_a, f.next_a}
                : View{*p.a, *p.b, p.pose_a, f.next_a, p.pose_b, f.next_b};
}

struct Counts {
    std::size_t same = 0, doubtful = 0;
};

Key key_of(const Contact& c) {
    return {c.feature.source_index(), c.feature.kind == FeatureKind::edges ? c.feature.index_b : 0};
}

/// side: whose vertices, or a for edges, seen from the other.
void compare(const Expectation& expected, std::span<const Contact> found, FeatureKind kind, const View& view, Side side,
             Counts& counts) {
    std::map<Key, const Contact*> got;
    for (const Contact& c : found)
        if (c.is_speculative() && c.feature.kind == kind && c.feature.source == side) {
            EXPECT_TRUE(got.emplace(key_of(c), &c).second) << "twice: " << c.feature.source_index();
        }
    for (const auto& [key, one] : expected.sure) {
        const auto at = got.find(key);
        if (at == got.end()) {
            ADD_FAILURE() << "missed: " << key.first << ", " << key.second << ", gap " << one.gap;
            continue;
        }
        const Contact& c = *at->second;
        const double sign = side == Side::a ? -1 : 1;
        const Vec3 n = sign * rotate(view.target_now, one.normal);
        EXPECT_NEAR(double(c.depth), -one.gap, 1e-5 * view.size());
        EXPECT_EQ(c.ray_length, -c.depth);
        EXPECT_LT(length(to_world(view.target, view.target_now, one.point) - c.point()), 1e-5 * view.size());
        if (one.gap > 1e-3 * view.size()) {
            const Vec3 its{double(c.normal.x), double(c.normal.y), double(c.normal.z)};
            EXPECT_LT(length(its - n), 1e-3) << key.first;
        }
        ++counts.same;
        got.erase(at);
    }
    for (const Key& key : expected.doubtful) counts.doubtful += got.erase(key);
    for (const auto& [key, contact] : got)
        ADD_FAILURE() << "invented: " << key.first << ", " << key.second << ", gap " << -contact->depth;
}

/// What touches, of a side: vertices, or two edges.
std::set<Key> touching(std::span<const Contact> contacts, FeatureKind kind, Side side) {
    std::set<Key> keys;
    for (const Contact& c : contacts)
        if (!c.is_speculative() && c.feature.kind == kind && c.feature.source == side) keys.insert(key_of(c));
    return keys;
}

/// Steps once from all flights, and hands each pair's contacts to check(flight, contacts).
template <class Check>
void step(const std::vector<Flight>& flights, const Settings& settings, Check&& check) {
    Scene scene(settings);
    const auto pairs = add_all(scene, beginnings(flights));
    for (std::size_t i = 0; i < flights.size(); ++i) {
        scene.set_next_pose(pairs[i].first, flights[i].next_a);
        scene.set_next_pose(pairs[i].second, flights[i].next_b);
    }
    scene.find_contacts(pairs);
    const auto speculative = std::ranges::count_if(scene.contacts(), &Contact::is_speculative);
    EXPECT_EQ(scene.stats().contacts_speculative, std::uint64_t(speculative));
    EXPECT_EQ(scene.stats().contacts, scene.contacts().size() - std::size_t(speculative));
    const auto parts = by_pair(scene.contacts(), flights.size());
    for (std::size_t i = 0; i < flights.size(); ++i) {
        SCOPED_TRACE(testing::Message() << "flight " << i);
        check(flights[i], parts[i]);
    }
}

double margin_of(const Settings& settings, const Flight& f) {
    if (settings.speculative_margin) return *settings.speculative_margin;
    return speculative_share * std::min(f.now.a->solid.diagonal, f.now.b->solid.diagonal);
}

void expect_vertices(const std::vector<Flight>& flights, const Settings& settings, Counts& counts) {
    step(flights, settings, [&](const Flight& f, std::span<const Contact> contacts) {
        for (const Side side : {Side::a, Side::b}) {
            const View seen = view(f, side == Side::b);
            std::set<std::uint32_t> vertices;
            for (const Key& key : touching(contacts, FeatureKind::vertex, side)) vertices.insert(key.first);
            compare(Vertices(seen, margin_of(settings, f)).expect(vertices), contacts, FeatureKind::vertex, seen, side,
                    counts);
        }
    });
}

TEST(Speculative, VerticesOnTheirWayAreThoseOfTheReference) {
    Counts counts;
    for (const Method method : {Method::certified, Method::standard}) {
        Settings settings = speculative_settings();
        settings.method = method;
        expect_vertices(random_flights(100, 1, 0.8), settings, counts);
    }
    std::printf("[ vertices ] %zu as expected, %zu doubtful\n", counts.same, counts.doubtful);
    EXPECT_GT(counts.same, 5000u);
    EXPECT_LT(counts.doubtful, counts.same / 100);
}

TEST(Speculative, VerticesWithinTheMarginAreThoseOfTheReference) {
    Counts counts;
    for (const std::optional<double> margin : {std::optional<double>(), std::optional<double>(0.05)}) {
        Settings settings = speculative_settings();
        settings.speculative_margin = margin;
        expect_vertices(random_flights(400, 2, 0.0005), settings, counts);
    }
    std::printf("[ vertices ] %zu as expected, %zu doubtful\n", counts.same, counts.doubtful);
    EXPECT_GT(counts.same, 1500u);
    EXPECT_LT(counts.doubtful, counts.same / 50);
}

TEST(Speculative, EdgesAreThoseOfTheReference) {
    Counts counts;
    Random random(3);
    std::vector<const Subject*> subjects; // coarse ones: every edge against every other
    for (const Subject* subject : pointers(closed_subjects()))
        if (subject->solid.triangles.size() < 200) subjects.push_back(subject);
    for (const auto& [margin, far] : {std::pair(std::optional<double>(), 0.6), std::pair(std::optional(0.06), 0.01)}) {
        Settings settings = speculative_settings();
        settings.features = Features::edges;
        settings.speculative_margin = margin;
        std::vector<Flight> flights;
        for (int i = 0; i < 2000; ++i) {
            Placement placed = random_placement(subjects, random);
            // Mostly a little apart.
            placed.pose_b.translation =
                placed.pose_b.translation + 0.4 * (placed.pose_b.translation - placed.pose_a.translation);
            const Pose next_a = moved(placed.pose_a, far, random), next_b = moved(placed.pose_b, far, random);
            flights.push_back({placed, next_a, next_b});
        }
        step(flights, settings, [&](const Flight& f, std::span<const Contact> contacts) {
            const View seen = view(f, false);
            const bool told =
                std::ranges::any_of(contacts, [](const Contact& c) { return c.feature.kind == FeatureKind::vertex; });
            const auto expected =
                Edges(seen, margin_of(settings, f), told).expect(touching(contacts, FeatureKind::edges, Side::a));
            compare(expected, contacts, FeatureKind::edges, seen, Side::a, counts);
        });
    }
    std::printf("[ edges    ] %zu as expected, %zu doubtful\n", counts.same, counts.doubtful);
    EXPECT_GT(counts.same, 300u);
    EXPECT_LT(counts.doubtful, counts.same / 10);
}

std::vector<Contact> touching_alone(std::span<const Contact> contacts) {
    std::vector<Contact> found;
    std::ranges::copy_if(contacts, std::back_inserter(found), [](const Contact& c) { return !c.is_speculative(); });
    return found;
}

TEST(Speculative, ChangesNothingThatTouchesAndNoThreadChangesIt) {
    const auto flights = random_flights(60, 2, 0.8);
    for (const Method method : {Method::standard, Method::certified, Method::iterative, Method::predictive}) {
        SCOPED_TRACE(to_string(method));
        std::vector<Contact> all, without;
        for (const std::uint32_t threads : {0u, 1u, 4u}) {
            Settings settings = speculative_settings();
            settings.features = Features::edges;
            settings.method = method;
            settings.execution.threads = std::max(1u, threads);
            settings.speculative = threads > 0;
            Scene scene(settings);
            const auto pairs = add_all(scene, beginnings(flights));
            for (std::size_t i = 0; i < flights.size(); ++i) {
                scene.set_next_pose(pairs[i].first, flights[i].next_a);
                scene.set_next_pose(pairs[i].second, flights[i].next_b);
            }
            const auto found = scene.find_contacts(pairs);
            ContactHash hash, hash_of_all(Direction::reprojected, true);
            hash.add(0, found);
            hash_of_all.add(0, found);
            EXPECT_EQ(hash.hex() == hash_of_all.hex(), threads == 0);
            if (threads == 0) without.assign(found.begin(), found.end());
            if (threads == 1) all.assign(found.begin(), found.end());
            EXPECT_TRUE(same_bits(touching_alone(found), without)) << threads;
            double ray_length = 0;
            for (const Contact& c : without) ray_length += double(c.ray_length);
            EXPECT_EQ(scene.stats().details.ray_length, ray_length);
            EXPECT_TRUE(threads == 0 || same_bits(found, all)) << threads;
        }
        EXPECT_GT(without.size(), 1000u);
        EXPECT_GT(all.size(), without.size() + 1000);
    }
}

// What touches is new when it did not touch before, whether or not it was seen coming; and lost when it no longer does.
TEST(Speculative, ATouchIsNewAndALiftIsLost) {
    const Subject& cube = closed_subjects()[6];
    const double size = cube.solid.diagonal;
    Scene scene(speculative_settings());
    scene.add(cube.shape);
    const BodyId body = scene.add(cube.shape);
    const double high = 2 * (cube.solid.box_max.z - cube.solid.box_min.z);
    const auto step_at = [&](double height) {
        const Pose pose{.translation = {0.1 * size, 0.05 * size, height}};
        scene.set_pose(body, pose);
        scene.set_next_pose(body, pose);
        scene.find_contacts();
    };
    double low = 0, gap = high; // where it only just touches, by halving
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + gap);
        step_at(middle);
        (scene.stats().contacts > 0 ? low : gap) = middle;
    }
    step_at(gap + 1e-3 * size);
    step_at(gap + 1e-3 * size);
    EXPECT_GT(scene.stats().contacts_speculative, 0u);
    EXPECT_EQ(scene.stats().contacts_new + scene.stats().contacts_lost, 0u);
    step_at(low - 1e-3 * size);
    EXPECT_GT(scene.stats().contacts, 0u);
    EXPECT_EQ(scene.stats().contacts_new, scene.stats().contacts);
    for (const Contact& c : scene.contacts()) EXPECT_TRUE(c.is_speculative() || c.is_new);
    const std::uint64_t touched = scene.stats().contacts;
    step_at(gap + 1e-3 * size);
    EXPECT_EQ(scene.lost_contacts().size(), touched);
    EXPECT_EQ(scene.stats().contacts, 0u);
}

// A body above its like, that the broad phase would not pair with it where they are.
TEST(Speculative, WithoutANextPoseTheLastMotionGoesOn) {
    const Subject& cube = closed_subjects()[6];
    Scene scene(speculative_settings());
    scene.add(cube.shape);
    const BodyId body = scene.add(cube.shape);
    const double size = cube.solid.diagonal;
    const auto step_at = [&](double height) {
        scene.set_pose(body, {.translation = {0.1 * size, 0.05 * size, height * size}});
        return scene.find_contacts().size();
    };
    EXPECT_EQ(step_at(2.7), 0u) << "it was never elsewhere";
    EXPECT_EQ(step_at(1.8), 0u) << "it comes to 0.9";
    EXPECT_GT(step_at(0.9), 0u) << "it comes to 0";
    EXPECT_EQ(scene.stats().contacts, 0u);
    const std::vector<Contact> expected(scene.contacts().begin(), scene.contacts().end());
    EXPECT_EQ(step_at(0.9), 0u) << "it stands still";
    EXPECT_EQ(step_at(1.8), 0u) << "it leaves";
    EXPECT_GT(step_at(0.9), 0u);
    step_at(2);
    EXPECT_EQ(step_at(0.9), 0u) << "farther than its own size: it was put there";
    step_at(0.9);
    scene.set_next_pose(body, {.translation = {0.1 * size, 0.05 * size, 0}});
    EXPECT_TRUE(same_bits(scene.find_contacts(), expected)) << "said, not guessed";
    EXPECT_TRUE(scene.find_contacts().empty()) << "it was said for one step";

    // A body that gets the slot of another does not inherit its way.
    scene.set_next_pose(body, {.translation = {0, 0, 0}});
    scene.remove(body);
    scene.find_contacts();
    scene.add(cube.shape, {.translation = {0, 0, 0.9 * size}});
    EXPECT_TRUE(scene.find_contacts().empty());
}

// Two bodies on either side of a third, at gaps of 1 and 4 % of their size.
TEST(Speculative, ABodyMayHaveAMarginOfItsOwn) {
    const Subject& prism = closed_subjects()[6];
    const double size = prism.solid.diagonal;
    const double wide = prism.solid.box_max.x - prism.solid.box_min.x;
    for (const Method method : {Method::standard, Method::certified}) {
        Settings settings = speculative_settings();
        settings.method = method;
        settings.features = Features::edges;
        Scene scene(settings);
        const BodyId middle = scene.add(prism.shape);
        const BodyId left = scene.add(prism.shape, {.translation = {-wide - 0.01 * size, 0, 0}});
        scene.add(prism.shape, {.translation = {wide + 0.04 * size, 0, 0}});
        const auto pairs_of = [&] {
            scene.find_contacts();
            std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
            for (const Contact& c : scene.contacts()) pairs.emplace(c.body_a.slot, c.body_b.slot);
            return pairs.size();
        };
        EXPECT_EQ(pairs_of(), 0u);
        scene.set_speculative_margin(left, 0.02 * size);
        EXPECT_EQ(pairs_of(), 1u);
        scene.set_speculative_margin(middle, 0.05 * size);
        EXPECT_EQ(pairs_of(), 2u) << "the larger counts";
        scene.set_speculative_margin(middle, std::nullopt);
        EXPECT_EQ(pairs_of(), 1u);
        EXPECT_THROW(scene.set_speculative_margin(left, -1), InputError);
        scene.remove(left);
        EXPECT_EQ(pairs_of(), 0u);
        scene.add(prism.shape, {.translation = {-wide - 0.01 * size, 0, 0}});
        EXPECT_EQ(pairs_of(), 0u) << "another body in its slot";
        EXPECT_THROW(scene.set_speculative_margin(left, 0.02), InputError);
    }
}

TEST(Speculative, BadMarginsAreRefused) {
    Settings settings = speculative_settings();
    for (const double bad :
         {-0.01, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        settings.speculative_margin = bad;
        EXPECT_THROW(Scene{settings}, InputError) << bad;
    }
}

TEST(Speculative, BadPosesAreRefused) {
    Scene scene(speculative_settings());
    const BodyId body = scene.add(closed_subjects()[0].shape);
    Pose bad;
    bad.translation.x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(scene.set_next_pose(body, bad), InputError);
    bad = {};
    bad.rotation[0] = 2;
    EXPECT_THROW(scene.set_next_pose(body, bad), InputError);
    scene.remove(body);
    EXPECT_THROW(scene.set_next_pose(body, {}), InputError);
}

} // namespace
