// SPDX-License-Identifier: Apache-2.0
// Scene::coming_contacts() against the reference: each vertex's straight way, cast against every triangle in double.
#include "property/shapes.h"
#include "reference/ray.h"
#include "reference/vector.h"

#include <raycontact/error.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

Settings continuous_settings() {
    Settings settings;
    settings.devices = "cpu";
    settings.continuous = true;
    return settings;
}

Vec3 to_local(const Subject& subject, const Pose& pose, const Vec3& world) {
    return rotate_back(pose, world - pose.translation) - subject.solid.centre;
}
Vec3 to_world(const Subject& subject, const Pose& pose, const Vec3& local) {
    return rotate(pose, local + subject.solid.centre) + pose.translation;
}

// A move by up to `far` metres and a turn by up to some 0.3.
Pose moved(const Pose& pose, double far, Random& random) {
    const Vec3 axis = 0.15 * random.in_ball();
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

std::vector<Flight> random_flights(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    auto subjects = pointers(closed_subjects());
    for (const Subject* open : pointers(open_subjects())) subjects.push_back(open);
    std::vector<Flight> flights;
    for (std::size_t i = 0; i < count; ++i) {
        Flight flight;
        flight.now = random_placement(subjects, random);
        flight.next_a = moved(flight.now.pose_a, 0.8, random);
        flight.next_b = moved(flight.now.pose_b, 0.8, random);
        flights.push_back(flight);
    }
    return flights;
}

std::vector<Placement> beginnings(const std::vector<Flight>& flights) {
    std::vector<Placement> placements(flights.size());
    std::ranges::transform(flights, placements.begin(), &Flight::now);
    return placements;
}

// Of one direction: by file vertex, what the way meets.
struct Coming {
    std::uint32_t triangle;
    double gap, way;
};
struct Expected {
    std::map<std::uint32_t, Coming> sure;
    std::vector<std::uint32_t> doubtful; ///< file vertices that touch an end of their way, or graze
};

Expected expect(const Subject& source, const Pose& now, const Pose& then, const Subject& target, const Pose& wall_now,
                const Pose& wall_then) {
    Expected expected;
    RayCaster caster(target.solid);
    const double hair = 3e-7 * std::min(source.solid.diagonal, target.solid.diagonal);
    for (std::size_t v = 0; v < source.solid.vertices.size(); ++v) {
        const Vec3 from = to_local(target, wall_now, to_world(source, now, source.solid.vertices[v]));
        const Vec3 to = to_local(target, wall_then, to_world(source, then, source.solid.vertices[v]));
        const double way = length(to - from);
        const std::uint32_t file = source.solid.vertex_index[v];
        const Vec3 direction = unit(to - from);
        const Hit hit = caster.closest(from, direction), behind = caster.closest(from, -direction);
        if (behind.distance < hair || hit.distance < hair || std::abs(hit.distance - way) < hair) {
            expected.doubtful.push_back(file);
            continue;
        }
        if (hit.triangle == Hit::none || hit.distance > way || hit.from_inside) continue;
        const Vec3& n = target.solid.face_normals[hit.triangle];
        const Vec3& corner = target.solid.vertices[target.solid.triangles[hit.triangle][0]];
        expected.sure[file] = {target.solid.triangle_index[hit.triangle], dot(from - corner, n), hit.distance};
    }
    return expected;
}

struct Counts {
    std::size_t same = 0, other_triangle = 0, doubtful = 0;
};

void compare(const Expected& expected, std::span<const Contact> found, VertexBody side, Counts& counts) {
    std::map<std::uint32_t, const Contact*> got;
    for (const Contact& c : found) {
        if (c.vertex_body != side) continue;
        EXPECT_TRUE(got.emplace(c.vertex, &c).second) << "twice: vertex " << c.vertex;
    }
    for (const auto& [vertex, coming] : expected.sure) {
        const auto at = got.find(vertex);
        if (at == got.end()) {
            ADD_FAILURE() << "missed: vertex " << vertex;
            continue;
        }
        const Contact& c = *at->second;
        EXPECT_NEAR(double(c.ray_length), coming.way, 1e-5);
        EXPECT_LE(c.depth, 0);
        EXPECT_EQ(c.feature, Feature::vertex);
        if (c.triangle == coming.triangle) {
            EXPECT_NEAR(double(c.depth), -coming.gap, 1e-5);
            ++counts.same;
        } else {
            ++counts.other_triangle; // an edge or corner was met
        }
        got.erase(at);
    }
    for (const std::uint32_t vertex : expected.doubtful) counts.doubtful += got.erase(vertex);
    for (const auto& [vertex, contact] : got) ADD_FAILURE() << "invented: vertex " << vertex;
}

TEST(Coming, AsTheReferenceFindsThem) {
    const auto flights = random_flights(300, 1);
    const std::vector<Placement> placements = beginnings(flights);
    Counts counts;
    for (const bool swapped : {false, true}) {
        Scene scene(continuous_settings());
        const auto pairs = add_all(scene, placements, swapped);
        for (std::size_t i = 0; i < flights.size(); ++i) {
            scene.set_next_pose(pairs[i].first, swapped ? flights[i].next_b : flights[i].next_a);
            scene.set_next_pose(pairs[i].second, swapped ? flights[i].next_a : flights[i].next_b);
        }
        scene.step(pairs);
        EXPECT_EQ(scene.stats().contacts_coming, scene.coming_contacts().size());
        const auto parts = by_pair(scene.coming_contacts(), flights.size());
        for (std::size_t i = 0; i < flights.size(); ++i) {
            const Flight& f = flights[i];
            const Placement& p = f.now;
            SCOPED_TRACE(testing::Message() << "flight " << i << (swapped ? ", swapped" : ""));
            compare(expect(*p.a, p.pose_a, f.next_a, *p.b, p.pose_b, f.next_b), parts[i],
                    swapped ? VertexBody::b : VertexBody::a, counts);
            compare(expect(*p.b, p.pose_b, f.next_b, *p.a, p.pose_a, f.next_a), parts[i],
                    swapped ? VertexBody::a : VertexBody::b, counts);
        }
    }
    std::printf("[ coming   ] %zu as expected, %zu on another triangle, %zu doubtful\n", counts.same,
                counts.other_triangle, counts.doubtful);
    EXPECT_GT(counts.same, 20000u);
    EXPECT_LT(counts.other_triangle, counts.same / 1000);
    EXPECT_LT(counts.doubtful, counts.same / 100);
}

TEST(Coming, ChangesNoContactAndNoThreadChangesIt) {
    const auto flights = random_flights(60, 2);
    const std::vector<Placement> placements = beginnings(flights);
    std::vector<Contact> contacts, coming;
    for (const std::uint32_t threads : {1u, 4u, 0u}) {
        Settings settings = continuous_settings();
        settings.threads = std::max(1u, threads);
        settings.continuous = threads > 0;
        Scene scene(settings);
        const auto pairs = add_all(scene, placements);
        for (std::size_t i = 0; i < flights.size(); ++i) {
            scene.set_next_pose(pairs[i].first, flights[i].next_a);
            scene.set_next_pose(pairs[i].second, flights[i].next_b);
        }
        const auto found = scene.step(pairs);
        if (threads == 1) {
            contacts.assign(found.begin(), found.end());
            coming.assign(scene.coming_contacts().begin(), scene.coming_contacts().end());
        }
        EXPECT_TRUE(same_bits(found, contacts)) << threads;
        EXPECT_TRUE(threads > 0 ? same_bits(scene.coming_contacts(), coming) : scene.coming_contacts().empty())
            << threads;
    }
    EXPECT_GT(contacts.size(), 1000u);
    EXPECT_GT(coming.size(), 1000u);
}

// A body above its like, that the broad phase would not pair with it where they are.
TEST(Coming, WithoutANextPoseTheLastMotionGoesOn) {
    const Subject& cube = closed_subjects()[6];
    Scene scene(continuous_settings());
    scene.add(cube.shape);
    const BodyId body = scene.add(cube.shape);
    const double size = cube.solid.diagonal;
    const auto step_at = [&](double height) {
        scene.set_pose(body, {.translation = {0.1 * size, 0.05 * size, height * size}});
        scene.step();
        return scene.coming_contacts().size();
    };
    EXPECT_EQ(step_at(4), 0u) << "it was never elsewhere";
    EXPECT_EQ(step_at(3), 0u) << "it comes to 2";
    EXPECT_GT(step_at(1.5), 0u) << "it comes to 0";
    EXPECT_TRUE(scene.contacts().empty());
    const std::vector<Contact> expected(scene.coming_contacts().begin(), scene.coming_contacts().end());
    EXPECT_EQ(step_at(1.5), 0u) << "it stands still";
    EXPECT_EQ(step_at(3), 0u) << "it leaves";
    step_at(1.5);
    step_at(1.5);
    scene.set_next_pose(body, {.translation = {0.1 * size, 0.05 * size, 0}});
    scene.step();
    EXPECT_TRUE(same_bits(scene.coming_contacts(), expected)) << "said, not guessed";
    scene.step();
    EXPECT_TRUE(scene.coming_contacts().empty()) << "it was said for one step";

    // A body that gets the slot of another does not inherit its way.
    scene.set_next_pose(body, {.translation = {0, 0, 0}});
    scene.remove(body);
    scene.step();
    scene.add(cube.shape, {.translation = {0, 0, 1.5 * size}});
    scene.step();
    EXPECT_TRUE(scene.coming_contacts().empty());
}

TEST(Coming, BadPosesAreRefused) {
    Scene scene(continuous_settings());
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
