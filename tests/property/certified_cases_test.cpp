// SPDX-License-Identifier: Apache-2.0
// The certified method where its proof is nearest to its end: one vertex at one face, matrices that are hardly
// rotations, numbers as large as they come, shapes that move in the store.
#include "prepared_shape.h"
#include "property/crowds.h"
#include "property/shapes.h"
#include "property/triplet.h"
#include "reference/meshes.h"
#include "reference/vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>
#include <string>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

std::vector<std::shared_ptr<const Shape>> some_shapes(Kind kind, std::size_t count, Random& random) {
    const auto& stock = crowd_shapes(kind, 1);
    std::vector<std::shared_ptr<const Shape>> shapes(count);
    for (auto& shape : shapes) shape = stock[random.below(static_cast<std::uint32_t>(stock.size()))];
    return shapes;
}

// One vertex straight at one face, where nothing is left over: the body flies or swings, or the face does, slowly or
// fast, as far as the vertex just goes in, and back. Distances to boxes are exact, so that a clock slow by a hundredth
// would be caught.
void strike(Random& random, Counts& counts, std::uint64_t number) {
    constexpr double scales[] = {1e-3, 1, 100};
    const std::size_t scale_index = random.below(std::size(scales));
    const double scale = scales[scale_index];
    static std::vector<std::shared_ptr<const Shape>> targets[std::size(scales)], sources[std::size(scales)];
    if (targets[scale_index].empty()) {
        const auto scaled = [&](Mesh mesh) {
            for (Vec3& v : mesh.vertices) v = scale * v;
            return prepared_shape(mesh);
        };
        for (const Mesh& mesh : {box_mesh({21, 21, 1}), box_mesh({0.5, 0.3, 0.4}), box_mesh({3, 0.1, 0.1})})
            targets[scale_index].push_back(scaled(mesh));
        for (const Mesh& mesh : {tetrahedron_mesh(), box_mesh({2, 0.02, 0.02}), bumpy_octahedron_mesh(4), bowl_mesh(4),
                                 box_mesh({21, 21, 1})})
            sources[scale_index].push_back(scaled(mesh));
    }
    const auto& target = targets[scale_index][random.below(3)];
    const auto& source = sources[scale_index][random.below(5)];

    // Touching: the source's lowest vertex on the target's upper face, z up in the target's frame.
    Pose touching = random.rotation();
    Vec3 lowest;
    for (const Vec3& v : source->vertices()) {
        const Vec3 p = rotate(touching, v);
        if (p.z < lowest.z || lowest == Vec3{}) lowest = p;
    }
    const Vec3 high = target->box_max();
    const double x = random.uniform(-0.95, 0.95);
    const double y = random.uniform(-0.95, 0.95);
    const Vec3 goal{x * high.x, y * high.y, high.z};
    touching.translation = goal - lowest;
    const Vec3 centre = touching.translation + rotate(touching, source->centre());

    // What turns about its own centre, and how: so that the vertex, or the face below it, comes straight on.
    const bool of_target = random.below(2) == 0;
    const bool swing = random.below(2) == 0;
    const Vec3 arm = of_target ? goal : goal - centre;
    const Vec3 axis = unit(cross({0, 0, 1}, arm));
    const double reach = swing ? std::max(1e-6 * scale, length(cross(axis, arm))) : 1;
    const double way = std::pow(10.0, random.uniform(-4, -0.5)) * scale;
    const Pose world = random.rotation();
    const auto poses_at = [&](double height) { // of the vertex above the face; below 0: inside
        Pose a;
        Pose b = touching;
        Pose& moving = of_target ? a : b;
        const double sign = of_target ? -1 : 1;
        if (swing) {
            const Pose turn = small_rotation(axis, -sign * height / reach);
            const Vec3 about = of_target ? Vec3{} : centre;
            moving = composed(turn, moving);
            moving.translation = about + rotate(turn, (of_target ? a.translation : touching.translation) - about);
            if (of_target) moving.translation = {};
        } else {
            moving.translation.z += sign * height;
        }
        return std::pair(composed(world, a), composed(world, b));
    };

    Settings settings;
    settings.execution.threads = 1;
    Triplet triplet(settings, thresholds[random.below(std::size(thresholds))], "strike " + std::to_string(number));
    const bool first = random.below(2) == 0;
    BodyId of_face, of_vertex;
    triplet.each([&](Scene& scene) {
        if (first) of_face = scene.add(target);
        of_vertex = scene.add(source);
        if (!first) of_face = scene.add(target);
    });
    const std::vector<Pair> pair{{of_face, of_vertex}};
    const int steps = 10 + static_cast<int>(random.below(120));
    // Some have come a long way: what they keep counts from far off.
    const int before = random.below(3) == 0 ? 20 : 0;
    const bool shear = random.below(4) == 0;
    for (int step = -before; step < 2 * steps; ++step) {
        const double to = std::fabs(1 - static_cast<double>(step) / steps); // 1 -> 0 -> 1
        const double height =
            step < 0 ? (step % 2 ? 1 : 1000) * scale * (swing ? 1e-3 : 1) : way * (1.03 * to - 0.03 * random.uniform());
        auto poses = poses_at(height);
        if (shear) poses = {sheared(poses.first, random), sheared(poses.second, random)};
        triplet.each([&](Scene& scene) {
            scene.set_pose(of_face, poses.first);
            scene.set_pose(of_vertex, poses.second);
        });
        triplet.step(counts, pair);
    }
    ++counts.episodes;
}

// That what a test is about did happen.
void expect_many(const char* what, std::uint64_t steps, std::uint64_t least, std::uint64_t contacts) {
    std::printf("[ counts   ] %llu steps %s, %llu contacts in them\n", static_cast<unsigned long long>(steps), what,
                static_cast<unsigned long long>(contacts));
    EXPECT_GT(steps, least);
    EXPECT_GT(contacts, 1000u);
}

TEST(certified, a_vertex_straight_at_a_face) {
    const auto strikes = static_cast<std::uint64_t>(std::max(300.0, 2e-5 * decisions_wanted()));
    Counts counts;
    for (std::uint64_t i = 0; i < strikes; ++i) {
        Random random(first_seed() + 400000 + i);
        strike(random, counts, i);
    }
    report("strikes", counts, 10.0 * static_cast<double>(strikes));
}

// Bodies that lie flat near the slab's corners, a millimetre deep: there a matrix that is no rotation is off by as
// much.
TEST(certified, flat_bodies_on_a_sheared_slab) {
    Counts counts;
    const auto slab = prepared_shape(box_mesh({21, 21, 1}));
    std::vector<std::shared_ptr<const Shape>> shapes;
    for (const Mesh& mesh : {grid_box_mesh(12), l_prism_mesh(), frame_mesh()}) shapes.push_back(prepared_shape(mesh));
    for (std::uint64_t i = 0; i < 30; ++i) {
        Random random(first_seed() + 700000 + i);
        Triplet triplet(some_settings(random), 1e-3, "flat bodies " + std::to_string(i));
        triplet.each([&](Scene& scene) { scene.add(slab); });
        std::vector<Pose> homes{Pose{}};
        for (std::uint32_t b = 0; b < 12; ++b) {
            const auto& shape = shapes[b % shapes.size()];
            triplet.each([&](Scene& scene) { scene.add(shape); });
            Pose home;
            const double x = random.uniform(15, 20);
            const double y = random.uniform(15, 20);
            home.translation = {b & 1 ? x : -x, b & 2 ? y : -y, 1 - random.uniform(0, 0.002)};
            homes.push_back(home);
        }
        for (int step = 0; step < 40; ++step) {
            for (std::uint32_t b = 0; b < homes.size(); ++b) {
                Pose pose = homes[b];
                pose.translation = pose.translation + 1e-3 * random.in_ball();
                if (b > 0 || i % 2) pose = sheared(pose, random);
                triplet.each([&](Scene& scene) { scene.set_pose({b}, pose); });
            }
            triplet.step(counts);
        }
        ++counts.episodes;
    }
    report("flat on sheared slab", counts, 1e3);
}

// Bodies of a crowd that stop and go on, each when it likes, while others come and go and some pairs are not asked for.
TEST(certified, bodies_that_stand_still) {
    Counts counts;
    std::uint64_t still_steps = 0;
    const std::uint64_t scenes = decisions_wanted() < 4e7 ? 16 : 40; // a sanitizer takes 10 s a scene
    for (std::uint64_t i = 0; i < scenes; ++i) {
        Random random(first_seed() + 800000 + i);
        Settings settings = soon_directed(some_settings(random));
        const bool large = i % 8 == 5; // many slices of pairs, and two threads
        if (large) settings.execution.threads = 2;
        Triplet triplet(settings, thresholds[random.below(std::size(thresholds))],
                        "standing still " + std::to_string(i));
        const auto shapes = some_shapes(i % 4 == 3 ? Kind::open : Kind::concave, large ? 40 : 16, random);
        const std::vector<Pose> homes = touching_poses(shapes, 0.1, random);
        std::vector<std::pair<BodyId, Mover>> bodies;
        std::size_t next = 0;
        const auto add = [&] {
            BodyId id;
            triplet.each([&](Scene& scene) { id = scene.add(shapes[next], homes[next]); });
            bodies.emplace_back(id, Mover(i % 2 ? Course::mixed : Course::drift, homes[next], 1, random));
            ++next;
        };
        while (next + 4 < shapes.size()) add();
        int still_for = 0;
        bool moves = false; // whether any body may
        for (int step = 0; step < 120; ++step) {
            if (random.below(6) == 0) moves = !moves;
            bool changed = false;
            if (random.below(30) == 0 && next < shapes.size()) {
                add();
                changed = true;
            } else if (random.below(40) == 0 && bodies.size() > 6) {
                triplet.each([&](Scene& scene) { scene.remove(bodies.front().first); });
                bodies.erase(bodies.begin());
                changed = true;
            }
            for (auto& [id, mover] : bodies) {
                if (!moves || random.below(3) != 0) continue;
                const BodyId body = id;
                const Pose pose = mover.next(random);
                triplet.each([&](Scene& scene) { scene.set_pose(body, pose); });
                changed = true;
            }
            std::vector<Pair> asked;
            const bool few = random.below(10) == 0; // pairs that are left out, once
            for (std::size_t a = 0; a < bodies.size(); ++a)
                for (std::size_t b = a + 1; b < bodies.size(); ++b)
                    if (!few || random.below(2) == 0) asked.emplace_back(bodies[a].first, bodies[b].first);
            triplet.step(counts, asked);
            still_for = changed || few ? 0 : still_for + 1;
            still_steps += still_for > 1;
        }
        ++counts.episodes;
    }
    report("standing still", counts, 1e4);
    EXPECT_GT(still_steps, 100u);
}

// Bodies that tremble by less than any block could be due for: their rays are decided, and no block is looked at.
TEST(certified, bodies_that_tremble) {
    Counts counts;
    std::uint64_t skipped = 0, contacts = 0;
    for (std::uint64_t i = 0; i < 20; ++i) {
        Random random(first_seed() + 850000 + i);
        Triplet triplet(some_settings(random), 0.05, "trembling " + std::to_string(i));
        const auto shapes = some_shapes(i % 4 == 3 ? Kind::open : Kind::concave, 10, random);
        const std::vector<Pose> homes = touching_poses(shapes, 0.1, random);
        for (std::size_t b = 0; b < shapes.size(); ++b)
            triplet.each([&](Scene& scene) { scene.add(shapes[b], homes[b]); });
        for (int step = 0; step < 60; ++step) {
            const double far = step % 20 == 19 ? 1e-2 : 1e-7; // what is kept runs out now and then
            for (std::uint32_t b = 0; b < shapes.size(); ++b) {
                if (random.below(20) == 0) continue;
                Pose pose = homes[b];
                pose.translation = pose.translation + far * random.in_ball();
                triplet.each([&](Scene& scene) { scene.set_pose({b}, pose); });
            }
            triplet.step(counts);
            triplet.each([&](Scene& scene) {
                if (scene.settings().method != Method::certified || scene.stats().details.vertices > 0) return;
                skipped += scene.stats().details.rays > 0 ? 1 : 0;
                contacts += scene.contacts().size();
            });
        }
        ++counts.episodes;
    }
    report("trembling", counts, 1e4);
    expect_many("without a block looked at", skipped, 200, contacts);
}

// Shapes that go take others to new places in the store while pairs of those are skipped.
TEST(certified, packed_shapes) {
    Counts counts;
    for (std::uint64_t i = 0; i < 20; ++i) {
        Random random(first_seed() + 600000 + i);
        Triplet triplet(some_settings(random), 1e-2, "packed shapes " + std::to_string(i));
        std::vector<BodyId> ballast(4);
        const auto add = [&](const std::shared_ptr<const Shape>& shape, const Pose& pose) {
            BodyId id;
            triplet.each([&](Scene& scene) { id = scene.add(shape, pose); });
            return id;
        };
        Pose away;
        away.translation = {1000, 0, 0};
        for (std::size_t k = 0; k < ballast.size(); ++k)
            ballast[k] = add(prepared_shape(model_mesh(k % 2 ? "gear" : "knot")), away);
        std::vector<std::shared_ptr<const Shape>> shapes;
        for (const Mesh& mesh : {bumpy_octahedron_mesh(5), frame_mesh(), l_prism_mesh(), tetrahedron_mesh()})
            for (int k = 0; k < 2; ++k) shapes.push_back(prepared_shape(mesh));
        const std::vector<Pose> homes = touching_poses(shapes, 0.3, random);
        std::vector<std::pair<BodyId, Mover>> bodies;
        for (std::size_t k = 0; k < shapes.size(); ++k)
            bodies.emplace_back(add(shapes[k], homes[k]), Mover(Course::drift, homes[k], 1, random));
        for (int step = 0; step < 60; ++step) {
            for (auto& [id, mover] : bodies) {
                const BodyId body = id;
                const Pose pose = mover.next(random);
                triplet.each([&](Scene& scene) { scene.set_pose(body, pose); });
            }
            if (step % 10 == 9 && !ballast.empty()) {
                triplet.each([&](Scene& scene) { scene.remove(ballast.back()); });
                ballast.pop_back();
            }
            triplet.step(counts);
        }
        ++counts.episodes;
    }
    report("packed shapes", counts, 1e4);
}

// Two bodies of one shape, twelve steps; place(step) gives their poses.
template <class Place>
void play_two(const std::shared_ptr<const Shape>& shape, const char* what, double far, Counts& counts, Place&& place) {
    Settings settings;
    settings.execution.threads = 1;
    char name[40];
    std::snprintf(name, sizeof name, "%s, %g m", what, far);
    Triplet triplet(settings, 1e-2, name);
    triplet.each([&](Scene& scene) {
        scene.add(shape);
        scene.add(shape);
    });
    const std::vector<Pair> pair{{BodyId{0}, BodyId{1}}};
    for (int step = 0; step < 12; ++step) {
        const std::pair<Pose, Pose> poses = place(step);
        triplet.each([&](Scene& scene) {
            scene.set_pose({0}, poses.first);
            scene.set_pose({1}, poses.second);
        });
        triplet.step(counts, pair);
    }
    ++counts.episodes;
}

// As far apart as finite numbers go, and back.
TEST(certified, beyond_the_range_of_squares) {
    const auto shape = prepared_shape(bumpy_octahedron_mesh(5));
    Counts counts;
    for (const double far : {1e30, 1e100, 1e200, 1.7e308})
        for (const bool begin_far : {false, true})
            play_two(shape, "apart", far, counts, [&](int step) {
                const bool away = (step / 3 % 2 == 0) == begin_far;
                Pose a, b;
                a.translation = {away ? -far : 0.0, 0, 0};
                b.translation = {away ? far : 0.9, away ? far : 0.0, 0};
                return std::pair(a, b);
            });
    report("very far", counts, 100);
}

// Away together, so far that the doubles of their positions lose how they lay to each other.
TEST(certified, far_away_together) {
    const auto shape = prepared_shape(box_mesh({0.5, 0.5, 0.5}));
    Counts counts;
    for (const double far : {1e12, 1e14, 1e15, 1e16, 1e17, 1e30})
        play_two(shape, "together", far, counts, [&](int step) {
            const double x = step / 3 % 2 == 0 ? 0 : far;
            Pose a, b = small_rotation({0, 0, 1}, 0.785);
            a.translation = {x, 0, 0};
            b.translation = {x + 2, 0.8, 0.1};
            return std::pair(a, b);
        });
    report("far away together", counts, 4);
}

// A rotation that stretches by as much as is accepted makes rays reach farther than their vertices' exit distances say.
TEST(certified, stretched_rays) {
    const auto small = prepared_shape(box_mesh({0.5, 0.5, 0.5}));
    Mesh mesh = grid_box_mesh(32); // [0, 1]^3
    for (Vec3& v : mesh.vertices) v = 4.8 * (v - Vec3{0.5, 0.5, 0.5});
    const auto large = prepared_shape(mesh);
    Random random(23);
    Counts counts;
    // 1.5e-4 too long along (1, 1, 1), and 5e-5 along an axis.
    const auto ones = [](Pose pose, double by) {
        const auto r = pose.rotation;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
                pose.rotation[3 * i + j] += by * (r[3 * i] + r[3 * i + 1] + r[3 * i + 2]);
        return pose;
    };
    Settings settings;
    settings.execution.threads = 1;
    settings.paper.displacement_threshold = 0.1; // no jump is left to the standard method
    Triplet triplet(settings, 0.2, "stretched rays");
    triplet.each([&](Scene& scene) {
        scene.add(small);
        scene.add(large);
    });
    // Takes the diagonal of the small box, along which its corner's ray runs, to an axis of the large one.
    const double c = 1 / std::sqrt(3.0), s = std::sqrt(2.0) * c;
    const double h = 1 / std::sqrt(2.0);
    Pose along;
    along.rotation = {c, c, c, -h, h, 0, -s / 2, -s / 2, s};
    constexpr double stretch = 4.99e-5;
    const Pose b = ones(Pose{}, stretch);
    triplet.each([&](Scene& scene) { scene.set_pose({1}, b); });
    const std::vector<Pair> pair{{BodyId{0}, BodyId{1}}};
    for (int round = 0; round < 10000; ++round) {
        Pose a = ones(along, stretch);
        const double deep = std::sqrt(3.0) * (1 + random.uniform(0.5e-4, 2e-4));
        const Vec3 corner = transform_point({a.rotation, {}}, {-0.5, -0.5, -0.5});
        const Vec3 seen{2.4 - deep, random.uniform(-1, 1), random.uniform(-1, 1)}; // from the large box, by a transpose
        const double sum = stretch * (seen.x + seen.y + seen.z);
        a.translation = seen - Vec3{sum, sum, sum} - corner;
        Pose away = a;
        away.translation.x += 40;
        for (const Pose& pose : {away, a}) {
            triplet.each([&](Scene& scene) { scene.set_pose({0}, pose); });
            triplet.step(counts, pair);
        }
    }
    ++counts.episodes;
    report("stretched rays", counts, 1e4);
}

// Coarse bodies that creep apart and back: what was found apart is asked again in time.
TEST(certified, edges_that_come_and_go) {
    std::vector<std::shared_ptr<const Shape>> shapes;
    for (const Mesh& mesh :
         {box_mesh({0.5, 0.5, 0.5}), box_mesh({1, 0.1, 0.15}), box_mesh({0.6, 0.6, 0.05}), tetrahedron_mesh(),
          cone_mesh(), l_prism_mesh(), frame_mesh(), bumpy_octahedron_mesh(2), bumpy_octahedron_mesh(10)})
        shapes.push_back(prepared_shape(mesh));
    Random random(3);
    std::size_t contacts = 0;
    for (int course = 0; course < 8000; ++course) {
        Settings settings;
        settings.features = Features::edges;
        settings.execution.threads = 1;
        settings.method = Method::certified;
        Scene certified(settings);
        settings.method = Method::standard;
        Scene standard(settings);
        const auto &a = shapes[random.below(9)], &b = shapes[random.below(9)];
        for (Scene* scene : {&certified, &standard}) {
            scene->add(a);
            scene->add(b);
        }
        Pose pose;
        for (int step = 0; step < 8; ++step) {
            if (step == 0 || random.below(4) == 0) {
                pose = random.rotation();
                pose.translation = 1.2 * random.in_ball();
            } else {
                pose.translation = pose.translation + 0.02 * random.in_ball();
            }
            for (Scene* scene : {&certified, &standard}) scene->set_pose({1}, pose);
            const auto expected = standard.find_contacts();
            ASSERT_TRUE(same_bits(certified.find_contacts(), expected)) << "course " << course << ", step " << step;
            contacts += expected.size();
        }
    }
    EXPECT_GT(contacts, 100000u);
}

} // namespace
