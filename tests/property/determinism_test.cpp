// SPDX-License-Identifier: Apache-2.0
// Equal input, equal bits: whatever the threads, the order of the pairs, or what happened in the scene before.
#include "prepared_shape.h"
#include "property/crowds.h"
#include "property/shapes.h"
#include "reference/vector.h"
#include "scenes/models/model.h"

#include <raycontact/error.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

using Shapes = std::vector<std::shared_ptr<const Shape>>;

const Shapes& closed_shapes() {
    static const Shapes shapes = [] {
        Shapes list;
        for (const Subject& subject : closed_subjects()) list.push_back(subject.shape);
        return list;
    }();
    return shapes;
}

// Forty bodies in a crowd that drift a little each step.
class Crowd {
public:
    explicit Crowd(const Settings& settings, const Shapes& shapes = closed_shapes()) : scene(settings), random_(99) {
        for (std::uint32_t i = 0; i < 40; ++i) {
            Pose pose = random_.rotation();
            pose.translation = 1.75 * random_.in_ball();
            scene.add(shapes[i % shapes.size()], pose);
            poses.push_back(pose);
        }
    }
    void move(double pace = 0.01) {
        for (std::uint32_t body = 0; body < poses.size(); ++body) {
            const Vec3 by = pace * random_.in_ball();
            poses[body].translation = poses[body].translation + by;
            scene.set_pose({body}, poses[body]);
        }
    }
    Scene scene;
    std::vector<Pose> poses;

private:
    Random random_;
};

Settings threads(std::uint32_t count) {
    Settings settings;
    settings.execution.threads = count;
    return settings;
}

std::vector<Contact> copy(std::span<const Contact> contacts) {
    return {contacts.begin(), contacts.end()};
}

struct Trace {
    std::vector<std::vector<Contact>> steps;
    std::string hash;
};

Trace run(const Settings& settings, const Shapes& shapes = closed_shapes()) {
    Trace result;
    Crowd crowd(settings, shapes);
    ContactHash hash;
    for (std::uint32_t step = 0; step < 12; ++step) {
        result.steps.push_back(copy(crowd.scene.find_contacts()));
        hash.add(step, result.steps.back());
        crowd.move();
    }
    result.hash = hash.hex();
    return result;
}

constexpr Method methods[] = {Method::standard, Method::iterative, Method::predictive, Method::certified};

TEST(determinism, threads_and_reruns_change_nothing) {
    std::map<Method, std::string> hashes;
    for (const Method method : methods) {
        const auto settings = [&](std::uint32_t count) {
            Settings made = threads(count);
            made.method = method;
            return made;
        };
        const Trace first = run(settings(1));
        std::size_t contacts = 0;
        for (const auto& step : first.steps) contacts += step.size();
        EXPECT_EQ(first.hash.size(), 16u);
        std::size_t runs = 1;
        for (const std::uint32_t count : {1u, 2u, 3u, 5u, 0u}) {
            const Trace other = run(settings(count));
            EXPECT_EQ(other.hash, first.hash) << to_string(method) << ", " << count << " threads";
            for (std::size_t i = 0; i < first.steps.size(); ++i)
                EXPECT_TRUE(same_bits(first.steps[i], other.steps[i]))
                    << to_string(method) << ", " << count << " threads, step " << i;
            ++runs;
        }
        std::printf("[ counts   ] %s: %zu runs of %zu steps, %zu contacts each, hash %s\n",
                    std::string(to_string(method)).c_str(), runs, first.steps.size(), contacts, first.hash.c_str());
        EXPECT_GE(contacts, 10000u);
        hashes[method] = first.hash;
    }
    EXPECT_EQ(hashes[Method::certified], hashes[Method::standard]);
}

// Coarse and finer meshes, whose edges cross.
TEST(determinism, threads_and_casters_change_no_edge) {
    for (const Method method : methods) {
        Settings settings = threads(1);
        settings.method = method;
        settings.features = Features::edges;
        const Trace first = run(settings, crowd_shapes(Kind::coarse, 1));
        std::size_t edges = 0;
        for (const auto& step : first.steps)
            for (const Contact& c : step) edges += c.feature.kind != FeatureKind::vertex;
        for (const std::uint32_t count : {1u, 2u, 3u, 4u})
            for (const Caster caster : {Caster::bvh, Caster::basic}) {
                settings.execution.threads = count;
                settings.paper.caster = caster;
                const Trace other = run(settings, crowd_shapes(Kind::coarse, 1));
                EXPECT_EQ(other.hash, first.hash) << to_string(method) << ", " << count << " threads";
                for (std::size_t i = 0; i < first.steps.size(); ++i)
                    EXPECT_TRUE(same_bits(first.steps[i], other.steps[i])) << to_string(method) << ", step " << i;
            }
        std::printf("[ counts   ] %s: %zu contacts of edges, hash %s\n", std::string(to_string(method)).c_str(), edges,
                    first.hash.c_str());
        EXPECT_GE(edges, 2000u);
    }
}

// Whatever a method misses of the vertices, it asks edges in full: a pair with the vertex contacts of `standard` has
// its contacts of edges, and a scene with edges has the vertex contacts of one without, and those that edges alone see.
TEST(determinism, every_method_asks_edges_in_full) {
    using Lists = std::map<Pair, std::array<std::vector<Contact>, 2>>; // of vertices, of edges
    const auto sorted = [](std::span<const Contact> contacts) {
        Lists lists;
        for (const Contact& c : contacts)
            lists[{c.body_a, c.body_b}][c.feature.kind != FeatureKind::vertex].push_back(c);
        return lists;
    };
    const auto& shapes = crowd_shapes(Kind::coarse, 1);
    for (const Method method : methods) {
        Settings settings = threads(1);
        settings.features = Features::edges;
        settings.method = Method::standard;
        Crowd standard(settings, shapes);
        settings.method = method;
        settings.paper.displacement_threshold = 0.05;
        Crowd other(settings, shapes);
        settings.features = Features::vertices;
        Crowd alone(settings, shapes);
        std::size_t alike = 0, all = 0, edges = 0;
        for (int step = 0; step < 24; ++step) {
            Lists expected = sorted(standard.scene.find_contacts()), found = sorted(other.scene.find_contacts());
            for (const auto& [pair, lists] : expected) found.try_emplace(pair);
            std::vector<Contact> vertices;
            for (auto& [pair, lists] : found) {
                vertices.insert(vertices.end(), lists[0].begin(), lists[0].end());
                ++all;
                if (!same_bits(lists[0], expected[pair][0])) continue;
                ++alike;
                edges += lists[1].size();
                EXPECT_TRUE(same_bits(lists[1], expected[pair][1])) << to_string(method) << ", step " << step;
            }
            const auto by_vertices = alone.scene.find_contacts();
            const auto is_among_them = [&](const Contact& c) {
                return std::ranges::any_of(by_vertices, [&](const Contact& own) {
                    return own.body_a == c.body_a && own.body_b == c.body_b && own.key() == c.key();
                });
            };
            std::erase_if(vertices, [&](const Contact& c) { return !is_among_them(c); });
            EXPECT_TRUE(same_bits(vertices, by_vertices)) << to_string(method) << ", step " << step;
            for (Crowd* crowd : {&standard, &other, &alone}) crowd->move(0.004);
        }
        std::printf("[ counts   ] %s: %zu of %zu pairs with the vertex contacts of standard, %zu contacts of edges\n",
                    std::string(to_string(method)).c_str(), alike, all, edges);
        EXPECT_GE(alike, 1000u);
        EXPECT_GE(edges, 2000u);
    }
}

// All that was counted of a step, beside the times.
std::vector<double> counters(const StepStats& s) {
    const std::uint64_t counted[] = {s.pairs,
                                     s.details.vertices,
                                     s.details.rays,
                                     s.details.rays_cast,
                                     s.details.side_tests,
                                     s.details.pairs_full,
                                     s.details.pairs_skipped,
                                     s.details.pairs_as_standard,
                                     s.details.walks,
                                     s.details.walks_lost,
                                     s.details.walk_casts,
                                     s.details.predictions,
                                     s.pair_bytes,
                                     s.contacts,
                                     s.contacts_new,
                                     s.contacts_lost};
    std::vector<double> all(std::begin(counted), std::end(counted));
    all.insert(all.end(), {s.details.ray_length, s.depth_max});
    return all;
}

// Bodies of fine meshes that creep, and now and then all go faster than normal-cone balls are asked.
TEST(determinism, threads_change_no_counter_where_caps_are_asked) {
    struct Step {
        std::vector<Contact> contacts;
        std::vector<double> counted;
    };
    Shapes shapes;
    for (const char* kind :
         {"sphere", "torus", "knot"}) // of which normal_cone_test says that normal-cone balls are asked
        shapes.push_back(prepared_shape(scenes::scene_model(kind, 4000).mesh));
    std::vector<Step> first;
    for (const std::uint32_t count : {1u, 2u, 3u, 5u}) {
        Crowd crowd(threads(count), shapes);
        std::uint64_t known = 0, rays = 0;
        for (std::size_t step = 0; step < 24; ++step) {
            const auto contacts = crowd.scene.find_contacts();
            const StepStats& stats = crowd.scene.stats();
            if (count == 1) first.push_back({copy(contacts), counters(stats)});
            EXPECT_TRUE(same_bits(first[step].contacts, contacts)) << count << " threads, step " << step;
            EXPECT_EQ(first[step].counted, counters(stats)) << count << " threads, step " << step;
            known += stats.details.rays - stats.details.rays_cast;
            rays += stats.details.rays;
            crowd.move(step % 6 == 5 ? 0.01 : 0.001);
        }
        EXPECT_GT(known, rays / 2);
    }
}

TEST(determinism, hash_sees_every_field_and_the_step) {
    const std::vector<Contact> contacts = run(threads(1)).steps[0];
    const auto hash_with = [](Direction direction, std::uint32_t step, std::span<const Contact> list) {
        ContactHash hash(direction);
        hash.add(step, list);
        return hash.hex();
    };
    const auto hash_of = [&](std::uint32_t step, std::span<const Contact> list) {
        return hash_with(Direction::reprojected, step, list);
    };
    const std::string plain = hash_of(0, contacts);
    EXPECT_EQ(plain, hash_of(0, contacts));
    EXPECT_NE(plain, hash_of(1, contacts));
    const auto changed = [&](auto change) {
        std::vector<Contact> other = contacts;
        change(other[other.size() / 2]);
        return hash_of(0, other);
    };
    EXPECT_NE(plain, changed([](Contact& c) { ++c.body_a.slot; }));
    EXPECT_NE(plain, changed([](Contact& c) { ++c.body_b.slot; }));
    EXPECT_NE(plain, changed([](Contact& c) { c.feature.source = c.feature.source == Side::a ? Side::b : Side::a; }));
    EXPECT_NE(plain,
              changed([](Contact& c) { ++(c.feature.source == Side::a ? c.feature.index_a : c.feature.index_b); }));
    EXPECT_NE(plain,
              changed([](Contact& c) { ++(c.feature.source == Side::a ? c.feature.index_b : c.feature.index_a); }));
    EXPECT_NE(plain, changed([](Contact& c) {
                  double& z = (c.feature.source == Side::a ? c.point_a : c.point_b).z;
                  z = std::nextafter(z, 1e9);
              }));
    EXPECT_NE(plain, changed([](Contact& c) { c.normal.y = std::nextafter(c.normal.y, 9.0f); }));
    EXPECT_NE(plain, changed([](Contact& c) { c.depth = std::nextafter(c.depth, 9.0f); }));
    EXPECT_NE(plain, changed([](Contact& c) { c.ray_length = std::nextafter(c.ray_length, 9.0f); }));

    // The weight is hashed where it means something.
    EXPECT_EQ(plain, hash_with(Direction::ray, 0, contacts));
    EXPECT_EQ(plain, changed([](Contact& c) { c.weight = 2; }));
    std::vector<Contact> heavier = contacts;
    heavier[contacts.size() / 2].weight = std::nextafter(1.0f, 9.0f);
    EXPECT_NE(hash_with(Direction::weighted, 0, contacts), plain);
    EXPECT_NE(hash_with(Direction::weighted, 0, contacts), hash_with(Direction::weighted, 0, heavier));
}

TEST(determinism, pairs_given_twice_or_in_any_order) {
    Crowd crowd({});
    const std::vector<Contact> expected = copy(crowd.scene.find_contacts());
    std::vector<Pair> pairs(crowd.scene.pairs().begin(), crowd.scene.pairs().end());
    ASSERT_GE(pairs.size(), 100u);
    EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end()));
    EXPECT_TRUE(same_bits(expected, crowd.scene.find_contacts(pairs)));
    std::vector<Pair> mixed(pairs.rbegin(), pairs.rend());
    mixed.insert(mixed.end(), pairs.begin(), pairs.end());
    for (std::size_t i = 0; i < mixed.size(); i += 2) std::swap(mixed[i].first, mixed[i].second);
    EXPECT_TRUE(same_bits(expected, crowd.scene.find_contacts(mixed)));
    EXPECT_EQ(crowd.scene.stats().pairs, pairs.size());
    EXPECT_TRUE(std::equal(pairs.begin(), pairs.end(), crowd.scene.pairs().begin(), crowd.scene.pairs().end()));
    EXPECT_TRUE(crowd.scene.find_contacts(std::span<const Pair>{}).empty());
    EXPECT_THROW(crowd.scene.find_contacts(std::vector<Pair>{{BodyId{3}, BodyId{3}}}), InputError);
    EXPECT_THROW(crowd.scene.find_contacts(std::vector<Pair>{{BodyId{0}, BodyId{4000}}}), InputError);
    EXPECT_TRUE(same_bits(expected, crowd.scene.find_contacts(pairs))); // a refused call left nothing behind
}

TEST(determinism, the_broad_phase_misses_no_contact) {
    Crowd crowd({});
    for (int step = 0; step < 3; ++step) {
        const std::vector<Contact> found = copy(crowd.scene.find_contacts());
        std::vector<Pair> all;
        for (std::uint32_t a = 0; a < crowd.poses.size(); ++a)
            for (std::uint32_t b = a + 1; b < crowd.poses.size(); ++b) all.emplace_back(BodyId{a}, BodyId{b});
        EXPECT_TRUE(same_bits(found, crowd.scene.find_contacts(all))) << "step " << step;
        EXPECT_GE(found.size(), 1000u);
        crowd.move();
    }
}

TEST(determinism, bodies_that_come_and_go_leave_no_trace) {
    Crowd plain({});
    Crowd eventful({});
    const Pose middle;
    for (int step = 0; step < 4; ++step) {
        const BodyId guest = eventful.scene.add(closed_subjects()[0].shape, middle);
        EXPECT_GE(eventful.scene.find_contacts().size(), plain.scene.find_contacts().size());
        eventful.scene.remove(guest);
        const BodyId other = eventful.scene.add(closed_subjects()[1].shape, middle);
        EXPECT_NE(other, guest) << "an id was given twice";
        eventful.scene.remove(other);
        EXPECT_THROW(eventful.scene.set_pose(other, middle), InputError);
        EXPECT_TRUE(same_bits(plain.scene.find_contacts(), eventful.scene.find_contacts()));
        EXPECT_EQ(eventful.scene.body_count(), plain.scene.body_count());
        plain.move();
        eventful.move();
    }
}

TEST(determinism, removing_a_body_removes_its_contacts_and_no_others) {
    Crowd crowd({});
    std::vector<Contact> expected = copy(crowd.scene.find_contacts());
    std::erase_if(expected, [](const Contact& c) { return c.body_a.slot == 7 || c.body_b.slot == 7; });
    crowd.scene.remove({7});
    EXPECT_TRUE(same_bits(expected, crowd.scene.find_contacts()));
    EXPECT_THROW(crowd.scene.find_contacts(std::vector<Pair>{{BodyId{6}, BodyId{7}}}), InputError);
}

TEST(determinism, a_teleport_there_and_back_leaves_no_trace) {
    Crowd crowd({});
    const std::vector<Contact> expected = copy(crowd.scene.find_contacts());
    Pose far = crowd.poses[5];
    far.translation = {1e6, -1e6, 1e6};
    crowd.scene.set_pose({5}, far);
    for (const Contact& c : crowd.scene.find_contacts()) EXPECT_TRUE(c.body_a.slot != 5 && c.body_b.slot != 5);
    crowd.scene.set_pose({5}, crowd.poses[5]);
    EXPECT_TRUE(same_bits(expected, crowd.scene.find_contacts()));
}

TEST(determinism, a_bad_pose_is_refused_by_name_and_the_old_one_stays) {
    Crowd crowd({});
    const std::vector<Contact> expected = copy(crowd.scene.find_contacts());
    const Pose good = crowd.poses[13];
    std::vector<Pose> bad(6, good);
    bad[0].translation.y = std::numeric_limits<double>::quiet_NaN();
    bad[1].rotation[4] = std::numeric_limits<double>::infinity();
    for (double& r : bad[2].rotation) r *= 1.01;                                           // scaled
    for (std::size_t i = 0; i < 3; ++i) bad[3].rotation[i] = -bad[3].rotation[i];          // mirrored
    for (std::size_t i = 0; i < 3; ++i) bad[4].rotation[i] += 0.01 * good.rotation[i + 3]; // sheared
    bad[5].rotation.fill(0);
    for (std::size_t i = 0; i < bad.size(); ++i) {
        try {
            crowd.scene.set_pose({13}, bad[i]);
            ADD_FAILURE() << "bad pose " << i << " was taken";
        } catch (const InputError& error) {
            const std::string text = error.what();
            EXPECT_NE(text.find("13"), std::string::npos) << text;
            EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        }
        EXPECT_EQ(crowd.scene.pose({13}), good);
        EXPECT_THROW(crowd.scene.add(closed_subjects()[0].shape, bad[i]), InputError);
    }
    EXPECT_TRUE(same_bits(expected, crowd.scene.find_contacts()));
}

} // namespace
