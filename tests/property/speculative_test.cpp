// SPDX-License-Identifier: Apache-2.0
// Speculative contacts against the reference; what they leave as it is; what a body is expected to do.
#include "prepared_shape.h"
#include "property/crowds.h"
#include "property/speculative_reference.h"
#include "reference/meshes.h"
#include "scenes/models/model.h"

#include <raycontact/error.h>
#include <raycontact/query.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <optional>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

Settings speculative_settings() {
    Settings settings;
    settings.execution.devices = "cpu";
    settings.speculative = Speculative::on;
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

/// Whether a contact tells a place, or one of the same vertex that stops it no later.
bool tells(const Contact& c, const Place& place, const View& seen, Side side) {
    const double sign = side == Side::a ? -1 : 1;
    const Vec3 n =
        sign * rotate_back(seen.target_now, Vec3{double(c.normal.x), double(c.normal.y), double(c.normal.z)});
    const bool named = place.edges ? c.feature.kind == FeatureKind::edges && c.feature.index_a == place.index
                                         && c.feature.index_b == place.other
                                   : c.feature.kind != FeatureKind::edges && c.feature.source == side
                                         && c.feature.source_index() == place.index;
    return named && dot(n, place.normal) > 0.99 && -double(c.depth) < place.gap + 1e-5 * seen.size();
}

struct Counts {
    std::size_t told = 0, missed = 0, right = 0, invented = 0;
};

/// Bodies that rest within the margin: all places are told, and nothing else is.
void expect_places(const Flight& f, std::span<const Contact> contacts, double margin, bool edges, Counts& counts) {
    constexpr double tolerance = 0.101;
    for (const Side side : {Side::a, Side::b}) {
        const View seen = view(f, side == Side::b);
        const NearestPlaces nearest(seen, margin, tolerance);
        std::vector<Place> places = nearest.of_vertices();
        if (edges && side == Side::a) std::ranges::copy(nearest.of_edges(), std::back_inserter(places));
        for (const Place& place : places) {
            if (!place.sure) continue;
            if (std::ranges::any_of(contacts, [&](const Contact& c) { return tells(c, place, seen, side); })) {
                ++counts.told;
                continue;
            }
            ++counts.missed;
            ADD_FAILURE() << (place.edges ? "edges " : "vertex ") << place.index << ", " << place.other
                          << " missed, gap " << place.gap;
        }
        for (const Contact& c : contacts) {
            const bool of_edges = c.feature.kind == FeatureKind::edges;
            if (!c.is_speculative() || -double(c.depth) < 1e-4 * seen.size() || c.feature.source != side) continue;
            const auto is_it = [&](const Place& place) {
                return place.edges == of_edges && tells(c, place, seen, side)
                       && -double(c.depth) > place.gap - 1e-5 * seen.size();
            };
            if (std::ranges::any_of(places, is_it)) {
                ++counts.right;
                continue;
            }
            ++counts.invented;
            ADD_FAILURE() << (of_edges ? "edges " : "vertex ") << c.feature.source_index() << ", "
                          << c.feature.other_index() << " invented, gap " << -c.depth;
        }
    }
}

std::vector<const Subject*> coarse_subjects() {
    std::vector<const Subject*> coarse; // every edge against every other
    for (const Subject* subject : pointers(closed_subjects()))
        if (subject->solid.triangles.size() < 200) coarse.push_back(subject);
    return coarse;
}

/// Two bodies without a turn until the next step, mostly a little apart.
Flight straight_flight(const std::vector<const Subject*>& subjects, double far, Random& random) {
    Flight f{random_placement(subjects, random), {}, {}};
    f.now.pose_b.translation = f.now.pose_b.translation + 0.4 * (f.now.pose_b.translation - f.now.pose_a.translation);
    f.next_a = f.now.pose_a, f.next_b = f.now.pose_b;
    f.next_a.translation = f.next_a.translation + far * random.in_ball();
    return f;
}

/// Two bodies at rest that are nearer than 0.04 and do not touch.
Flight near_flight(const std::vector<const Subject*>& subjects, Random& random) {
    Flight f = straight_flight(subjects, 0, random);
    for (int i = 0; i < 20; ++i) {
        const auto apart = distance(*f.now.a->shape, f.now.pose_a, *f.now.b->shape, f.now.pose_b);
        const Vec3 off = f.now.pose_b.translation - f.now.pose_a.translation;
        if (apart->distance > 0 && apart->distance < 0.04) break;
        const Vec3 by =
            apart->distance > 0 ? (1 - 0.02 / apart->distance) * (apart->point_a - apart->point_b) : 0.1 * off;
        f.now.pose_b.translation = f.now.pose_b.translation + by;
    }
    f.next_a = f.now.pose_a, f.next_b = f.now.pose_b;
    return f;
}

TEST(Speculative, EveryNearestPlaceIsToldAndNothingElse) {
    auto all = pointers(closed_subjects());
    for (const Subject* open : pointers(open_subjects())) all.push_back(open);
    Counts counts;
    for (const bool edges : {false, true}) {
        Random random(edges ? 3 : 2);
        std::vector<Flight> flights;
        for (int i = 0; i < (edges ? 1500 : 200); ++i)
            flights.push_back(near_flight(edges ? coarse_subjects() : all, random));
        for (const Method method : {Method::standard, Method::certified}) {
            Settings settings = speculative_settings();
            settings.method = method;
            settings.features = edges ? Features::edges : Features::vertices;
            settings.speculative_margin = 0.05;
            step(flights, settings, [&](const Flight& f, std::span<const Contact> contacts) {
                if (std::ranges::all_of(contacts, &Contact::is_speculative))
                    expect_places(f, contacts, 0.05, edges, counts);
            });
        }
    }
    std::printf("[ places   ] %zu told, %zu missed; %zu contacts right, %zu invented\n", counts.told, counts.missed,
                counts.right, counts.invented);
    EXPECT_GT(counts.told, 3000u);
}

/// The part of a way without a turn at which two surfaces meet first, above 1 if they do not: every vertex against
/// every triangle, every edge against every edge.
double first_meeting(const View& seen) {
    const Solid &source = seen.source.solid, &target = seen.target.solid;
    const Vec3 way = seen.at_then({}) - seen.at_now({});
    double first = 2;
    const auto cast = [&](const Vec3& p, const Vec3& along, const Solid& solid) {
        for (const auto& [i, j, k] : solid.triangles) {
            const Vec3 a = solid.vertices[i] - p, b = solid.vertices[j] - p, c = solid.vertices[k] - p;
            const double u = dot(cross(b, c), along), v = dot(cross(c, a), along), w = dot(cross(a, b), along);
            if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0)) || u + v + w == 0) continue;
            const double at =
                (u * dot(a, along) + v * dot(b, along) + w * dot(c, along)) / (u + v + w) / dot(along, along);
            if (at >= 0) first = std::min(first, at);
        }
    };
    for (const Vec3& v : source.vertices) cast(seen.at_now(v), way, target);
    Solid moved = source;
    for (Vec3& v : moved.vertices) v = seen.at_now(v);
    for (const Vec3& v : target.vertices) cast(v, -way, moved);
    for (const auto& e : source.edges)
        for (const auto& g : target.edges) {
            const Vec3 p = moved.vertices[e[0]], along = moved.vertices[e[1]] - p;
            const Vec3 q = target.vertices[g[0]], other = target.vertices[g[1]] - q;
            const double volume = dot(cross(along, other), way); // p + s along + t way = q + u other
            if (volume == 0) continue;
            const double t = dot(cross(along, other), q - p) / volume, s = dot(cross(q - p, other), way) / volume,
                         u = dot(cross(q - p, along), way) / volume;
            if (t >= 0 && s >= 0 && s <= 1 && u >= 0 && u <= 1) first = std::min(first, t);
        }
    return first;
}

// Of two that meet, a contact stops them when they do, not earlier and not later; of others, none does.
TEST(Speculative, WhatMeetsIsStoppedThere) {
    constexpr double margin = 1e-5;
    std::size_t met = 0, free = 0, late = 0, early = 0;
    Random random(5);
    std::vector<Flight> flights;
    for (int i = 0; i < 6000; ++i) flights.push_back(straight_flight(coarse_subjects(), 1.5, random));
    for (const Method method : {Method::standard, Method::certified}) {
        Settings settings = speculative_settings();
        settings.method = method;
        settings.features = Features::edges;
        settings.speculative_margin = margin;
        step(flights, settings, [&](const Flight& f, std::span<const Contact> contacts) {
            if (intersects(*f.now.a->shape, f.now.pose_a, *f.now.b->shape, f.now.pose_b)) return;
            const Vec3 way = f.next_a.translation - f.now.pose_a.translation;
            const double meets = first_meeting(view(f, false)), slack = 1e-3 + 10 * margin / length(way);
            double stops = 2, steep = 2; // steep: by what the motion does not glance along
            for (const Contact& c : contacts) {
                const Vec3 n{double(c.normal.x), double(c.normal.y), double(c.normal.z)}; // from a to b
                const double speed = dot(n, way), gap = -double(c.depth);
                if (!(speed > 0 && gap < speed)) continue;
                stops = std::min(stops, gap / speed);
                if (speed > 0.25 * length(way)) steep = std::min(steep, gap / speed);
            }
            ++(meets < 1 ? met : free);
            if (meets < 1 - slack && stops > meets + slack) {
                ++late;
                ADD_FAILURE() << "meets at " << meets << ", stopped at " << stops;
            }
            if (steep < meets - slack && steep < 1 - slack) {
                ++early;
                ADD_FAILURE() << "stopped at " << steep << ", meets at " << meets;
            }
        });
    }
    std::printf("[ ways     ] %zu meet, %zu do not; %zu stopped late, %zu early\n", met, free, late, early);
    EXPECT_GT(met, 1000u);
    EXPECT_GT(free, 1000u);
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
            settings.speculative = threads > 0 ? Speculative::on : Speculative::off;
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

// The lowest corner of a turning plate, which its motion lifts a little: where something stops the plate elsewhere it
// comes down by up to half the plate's way. Of a block as large, that is thicker than that, no such place is told.
TEST(Speculative, AThinBodySeesAsFarAsItMayBeThrown) {
    Random random(65);
    const auto slab = Shape::make(box_mesh({2, 2, 0.25}));
    std::size_t told = 0, beyond = 0;
    for (int i = 0; i < 400; ++i) {
        const bool thin = i % 4 != 0;
        const Mesh mesh = box_mesh({0.15, 0.1, thin ? 0.0005 + 0.0015 * random.uniform() : 0.1});
        Pose now = random.rotation();
        const auto lowest_of = [&](const Pose& pose) {
            return *std::ranges::min_element(mesh.vertices, {},
                                             [&](const Vec3& v) { return transform_point(pose, v).z; });
        };
        const Vec3 lowest = lowest_of(now);
        const Pose turned = moved(now, 0.6, random);
        const double gap = 0.002 + 0.03 * random.uniform();
        now.translation = Vec3{0, 0, 0.25 + gap} - transform_point(now, lowest);
        Pose next = turned;
        next.translation = {};
        next.translation = Vec3{0, 0, 0.25 + gap + 0.0005} - transform_point(next, lowest);
        // What the motion passes is told anyway.
        if (lowest_of(next) != lowest) continue;
        double way = 0;
        const double size = 2 * length(mesh.vertices[0]);
        for (const Vec3& v : mesh.vertices)
            way = std::max(way, length(transform_point(next, v) - transform_point(now, v)));
        for (const Method method : {Method::standard, Method::certified}) {
            Settings settings = speculative_settings();
            settings.method = method;
            settings.speculative_margin = 0.001;
            Scene scene(settings);
            const BodyId plate = scene.add(Shape::make(mesh), now), below = scene.add(slab);
            scene.set_next_pose(plate, next);
            const auto corner =
                static_cast<std::uint32_t>(std::ranges::find(mesh.vertices, lowest) - mesh.vertices.begin());
            const bool is_told =
                std::ranges::any_of(scene.find_contacts(std::array{std::pair(plate, below)}), [&](const Contact& c) {
                    return c.feature.source == Side::a && c.feature.source_index() == corner
                           && std::fabs(double(c.depth) + gap) < 1e-6;
                });
            EXPECT_TRUE(is_told || !(thin && gap < std::min(0.4 * way, 0.045 * size))) << i << ' ' << gap << ' ' << way;
            EXPECT_FALSE(is_told && (!thin || gap > std::min(0.75 * way, 0.051 * size)))
                << i << ' ' << gap << ' ' << way;
            told += is_told;
            beyond += !is_told;
        }
    }
    std::printf("[ thin     ] %zu told, %zu not\n", told, beyond);
    EXPECT_GT(told, 50u);
    EXPECT_GT(beyond, 50u);
}

/// A disc whose rim has no vertices but at its borders.
Mesh disc_mesh(std::uint32_t sides) {
    Mesh mesh;
    mesh.vertices = {{0, 0, -0.1}, {0, 0, 0.1}};
    for (std::uint32_t i = 0; i < sides; ++i) {
        const double angle = 2 * 3.14159265358979 * i / sides;
        for (const double z : {-0.1, 0.1}) mesh.vertices.push_back({std::cos(angle), std::sin(angle), z});
    }
    for (std::uint32_t i = 0; i < sides; ++i) {
        const std::uint32_t p = 2 + 2 * i, q = 2 + 2 * ((i + 1) % sides);
        for (const auto& triangle : {std::array{0u, q, p}, {1u, p + 1, q + 1}, {p, q, q + 1}, {p, q + 1, p + 1}})
            mesh.triangles.push_back(triangle);
    }
    return mesh;
}

// Two edges that hide little have no contact before bodies touch. Others have, wherever two bodies meet.
TEST(Speculative, FineBodiesAreSeenBeforeTheyTouch) {
    std::vector<std::shared_ptr<const Shape>> shapes{prepared_shape(disc_mesh(1000)), prepared_shape(disc_mesh(200)),
                                                     prepared_shape(box_mesh({1.5, 0.5, 0.4}))};
    for (const char* kind : {"sphere", "torus", "knot", "gear"})
        for (const std::uint32_t triangles : {4000u, 20000u})
            shapes.push_back(prepared_shape(scenes::scene_model(kind, triangles).mesh));
    Random random(66);
    double latest = 1;
    for (int i = 0; i < 600; ++i) {
        const auto count = static_cast<std::uint32_t>(shapes.size());
        const auto &a = shapes[i % 4 == 0 ? 2 : random.below(count)], &b = shapes[random.below(count)];
        Settings settings = speculative_settings();
        settings.features = Features::edges;
        Scene scene(settings);
        const Pose pose_a = random.rotation();
        Pose pose_b = random.rotation();
        pose_b.translation = 6 * random.direction();
        scene.add(a, pose_a);
        const BodyId moving = scene.add(b, pose_b);
        const auto size = [](const Shape& shape) { return length(shape.box_max() - shape.box_min()); };
        const double margin = speculative_share * std::min(size(*a), size(*b));
        const auto gap = [&] { return distance(*a, pose_a, *b, pose_b); };
        // As far as nothing can be told, then by a twentieth of the margin.
        for (double apart = gap()->distance; apart > 1.1 * margin; apart = gap()->distance) {
            const Vec3 way = gap()->point_a - gap()->point_b;
            pose_b.translation = pose_b.translation + (1 - margin / apart) * way;
        }
        const Vec3 step = 0.05 * margin * unit(gap()->point_a - gap()->point_b);
        for (int k = 0; k < 40; ++k) {
            scene.set_pose(moving, pose_b);
            scene.find_contacts();
            if (!scene.contacts().empty()) break;
            pose_b.translation = pose_b.translation + step;
        }
        ASSERT_FALSE(scene.contacts().empty()) << "approach " << i;
        EXPECT_TRUE(scene.contacts()[0].is_speculative()) << "approach " << i;
        EXPECT_GT(gap()->distance, 0.9 * margin) << "approach " << i;
        latest = std::min(latest, gap()->distance / margin);
    }
    std::printf("[ approach ] the latest told at %.2f of the margin\n", latest);
}

// As seen from one that turns the other flies past it. Both methods ask the same.
TEST(Speculative, BodiesThatTurnBesideEachOther) {
    std::vector<std::shared_ptr<const Shape>> shapes{prepared_shape(box_mesh({1, 0.6, 0.4}))};
    for (const char* kind : {"gear", "knot"}) shapes.push_back(prepared_shape(scenes::scene_model(kind, 4000).mesh));
    Random random(67);
    std::size_t contacts = 0;
    for (int i = 0; i < 150; ++i) {
        const auto &a = shapes[random.below(3)], &b = shapes[random.below(3)];
        Settings settings = speculative_settings();
        settings.features = Features::edges;
        Scene certified(settings);
        settings.method = Method::standard;
        Scene standard(settings);
        std::array poses{random.rotation(), random.rotation()};
        poses[1].translation = 3 * random.direction();
        const double margin = speculative_share * length(a->box_max() - a->box_min());
        const auto gap = distance(*a, poses[0], *b, poses[1]);
        const double apart = margin * random.uniform(0.2, 4);
        poses[1].translation = poses[1].translation + (1 - apart / gap->distance) * (gap->point_a - gap->point_b);
        for (Scene* scene : {&certified, &standard}) {
            scene->add(a, poses[0]);
            scene->add(b, poses[1]);
        }
        const double turn = margin * std::exp(random.uniform(-2, 2)); // of bodies about 1 m in radius
        const Vec3 axis = random.direction();
        for (int k = 0; k < 12; ++k) {
            for (std::uint32_t body = i % 2; body < 2; ++body) {
                const Vec3 at = poses[body].translation;
                poses[body] = composed(small_rotation(axis, turn), poses[body]);
                poses[body].translation = at;
                for (Scene* scene : {&certified, &standard}) scene->set_pose({body}, poses[body]);
            }
            for (Scene* scene : {&certified, &standard}) scene->find_contacts();
            ASSERT_TRUE(same_bits(standard.contacts(), certified.contacts())) << "pair " << i << ", step " << k;
            contacts += certified.contacts().size();
        }
    }
    EXPECT_GT(contacts, 1000u);
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
