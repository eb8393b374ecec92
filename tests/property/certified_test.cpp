// SPDX-License-Identifier: Apache-2.0
// The certified method gives the contacts of the standard method, bit for bit, whatever the meshes and however they
// move. RAYCONTACT_DECISIONS sets how many rays the standard method decides for it; a hundred million unless told.
// RAYCONTACT_SEED makes it others.
#include "property/crowds.h"
#include "property/shapes.h"
#include "reference/meshes.h"
#include "reference/vector.h"
#include "scenes/models/model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <string>
#include <tuple>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

double decisions_wanted() {
    const char* text = std::getenv("RAYCONTACT_DECISIONS");
    return text ? std::max(1e5, std::strtod(text, nullptr)) : 1e8;
}

std::uint64_t first_seed() {
    const char* text = std::getenv("RAYCONTACT_SEED");
    return text ? std::strtoull(text, nullptr, 10) << 32 : 0;
}

struct Counts {
    std::uint64_t episodes = 0, steps = 0;
    std::uint64_t decisions = 0;         ///< rays of the standard scenes; each certified scene has to come to the same
    std::uint64_t contacts = 0;          ///< of the standard scenes
    std::uint64_t cast = 0;              ///< rays cast by the first certified scene
    std::uint64_t pairs = 0, asleep = 0; ///< ordered pairs of that scene
    std::uint64_t missed = 0, invented = 0, other = 0;
    std::string first; ///< of the wrong ones, in words
};

auto key(const Contact& c) {
    return std::tuple(c.body_a, c.body_b, c.vertex_body, c.vertex);
}

bool same_lost(std::span<const LostContact> x, std::span<const LostContact> y) {
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const LostContact& c, const LostContact& d) {
        return std::tie(c.body_a, c.body_b, c.vertex_body, c.vertex)
               == std::tie(d.body_a, d.body_b, d.vertex_body, d.vertex);
    });
}

// One scene by the standard method and two by the certified one, fed alike: one chooses what it keeps itself, the
// other is told.
class Triplet {
public:
    Triplet(const Settings& settings, double threshold, std::string what)
        : standard(of(settings, Method::standard, {})), scenes{&standard, &own, &told},
          own(of(settings, Method::certified, {})), told(of(settings, Method::certified, threshold)),
          what_(std::move(what)) {}

    template <class Do>
    void each(Do&& change) {
        for (Scene* scene : scenes) change(*scene);
    }

    template <class... Pairs>
    void step(Counts& counts, const Pairs&... pairs) {
        each([&](Scene& scene) { scene.step(pairs...); });
        ++counts.steps;
        counts.decisions += standard.stats().rays;
        counts.contacts += standard.contacts().size();
        counts.cast += own.stats().rays_cast;
        counts.pairs += 2 * own.stats().pairs;
        counts.asleep += own.stats().pairs_asleep;
        for (const Scene* scene : {&own, &told}) compare(*scene, counts);
        ++steps_;
    }

    static Settings of(Settings settings, Method method, std::optional<double> threshold) {
        settings.method = method;
        settings.displacement_threshold = threshold;
        return settings;
    }

    Scene standard;

private:
    void compare(const Scene& scene, Counts& counts) {
        const auto expected = standard.contacts(), found = scene.contacts();
        const auto alike = [](const Contact& c, const Contact& d) { return c.is_new == d.is_new; };
        if (same_bits(expected, found) && std::equal(expected.begin(), expected.end(), found.begin(), alike)
            && same_lost(standard.lost_contacts(), scene.lost_contacts()))
            return;
        std::size_t i = 0, j = 0;
        const std::uint64_t before = counts.missed + counts.invented + counts.other;
        while (i < expected.size() || j < found.size()) {
            if (j == found.size() || (i < expected.size() && key(expected[i]) < key(found[j]))) {
                ++counts.missed;
                describe("missed", expected[i++], scene, counts);
            } else if (i == expected.size() || key(found[j]) < key(expected[i])) {
                ++counts.invented;
                describe("invented", found[j++], scene, counts);
            } else {
                if (!same_bits(expected.subspan(i, 1), found.subspan(j, 1)) || !alike(expected[i], found[j])) {
                    ++counts.other;
                    describe("other numbers", found[j], scene, counts);
                }
                ++i, ++j;
            }
        }
        if (before == counts.missed + counts.invented + counts.other) ++counts.other; // lost contacts alone
    }

    void describe(const char* how, const Contact& c, const Scene& scene, Counts& counts) const {
        if (!counts.first.empty()) return;
        const auto threshold = scene.settings().displacement_threshold;
        char text[300];
        std::snprintf(text, sizeof text, "%s: %s, step %llu, threshold %g, bodies %u and %u, vertex %u of %c, depth %g",
                      how, what_.c_str(), static_cast<unsigned long long>(steps_), threshold ? *threshold : -1.0,
                      c.body_a, c.body_b, c.vertex, c.vertex_body == VertexBody::a ? 'a' : 'b',
                      static_cast<double>(c.depth));
        counts.first = text;
    }

    Scene* scenes[3];
    Scene own, told;
    std::string what_;
    std::uint64_t steps_ = 0;
};

constexpr double thresholds[] = {0, 1e-6, 1e-4, 1e-2, 0.3, 100, 1e300};

struct Episode {
    Kind kind = Kind::concave;
    Course course = Course::mixed;
    double scale = 1;
    Vec3 origin;           ///< of the crowd, metres
    bool rounded = false;  ///< poses to float32
    bool together = false; ///< the whole crowd flies and turns about its origin
    std::uint32_t bodies = 16;
    double tightness = 0.3; ///< how far bodies stand from each other's surfaces, in their sizes
    int steps = 200;
    std::uint64_t seed = 0;

    std::string name() const {
        char text[200];
        std::snprintf(text, sizeof text, "%s, %s, scale %g, %g m from the origin%s%s, seed %llu", name_of(kind),
                      name_of(course), scale, length(origin), rounded ? ", rounded" : "",
                      together ? ", all together" : "", static_cast<unsigned long long>(seed));
        return text;
    }
};

Settings some_settings(Random& random) {
    Settings settings;
    settings.threads = 1;
    settings.skip_outside = random.below(4) != 0; // now and then every ray is cast
    settings.direction = random.below(2) ? Direction::ray : Direction::reprojected;
    return settings;
}

void play(const Episode& episode, Counts& counts) {
    Random random(episode.seed);
    const auto& stock = crowd_shapes(episode.kind, episode.scale);
    std::vector<std::shared_ptr<const Shape>> shapes;
    for (std::uint32_t i = 0; i < episode.bodies; ++i) {
        const bool slab = episode.kind == Kind::slab;
        const auto choice = slab ? 1 + random.below(static_cast<std::uint32_t>(stock.size() - 1))
                                 : random.below(static_cast<std::uint32_t>(stock.size()));
        shapes.push_back(stock[slab && i == 0 ? 0 : choice]);
    }
    const std::vector<Pose> homes = touching_poses(shapes, episode.tightness, random);

    const Settings settings = some_settings(random);
    const double threshold = thresholds[random.below(std::size(thresholds))];
    Triplet triplet(settings, threshold, episode.name());
    std::vector<Mover> movers;
    for (std::uint32_t i = 0; i < episode.bodies; ++i) {
        triplet.each([&](Scene& scene) { scene.add(shapes[i]); });
        movers.emplace_back(episode.course, homes[i], length(shapes[i]->box_max() - shapes[i]->box_min()), random);
    }
    Pose frame;
    frame.translation = episode.origin;
    const Vec3 velocity = 3 * episode.scale * random.in_ball();
    const Vec3 axis = random.direction();
    for (int step = 0; step < episode.steps; ++step) {
        for (BodyId body = 0; body < episode.bodies; ++body) {
            Pose pose = composed(frame, movers[body].next(random));
            if (episode.rounded) pose = rounded_to_float(pose);
            triplet.each([&](Scene& scene) { scene.set_pose(body, pose); });
        }
        if (episode.together) {
            const Vec3 at = frame.translation + velocity;
            frame = composed(small_rotation(axis, 0.05), frame);
            frame.translation = at;
        }
        triplet.step(counts);
    }
    ++counts.episodes;
}

void report(const char* what, const Counts& c, double wanted) {
    const std::uint64_t wrong = c.missed + c.invented + c.other;
    std::printf("[ counts   ] %s: %llu decisions in %llu steps of %llu scenes, %llu contacts; certified cast %.2f %%, "
                "%.1f %% of the pairs asleep; wrong %llu (%llu missed, %llu invented, %llu other)\n",
                what, static_cast<unsigned long long>(c.decisions), static_cast<unsigned long long>(c.steps),
                static_cast<unsigned long long>(c.episodes), static_cast<unsigned long long>(c.contacts),
                c.decisions ? 100.0 * static_cast<double>(c.cast) / static_cast<double>(c.decisions) : 0.0,
                c.pairs ? 100.0 * static_cast<double>(c.asleep) / static_cast<double>(c.pairs) : 0.0,
                static_cast<unsigned long long>(wrong), static_cast<unsigned long long>(c.missed),
                static_cast<unsigned long long>(c.invented), static_cast<unsigned long long>(c.other));
    EXPECT_EQ(wrong, 0u) << c.first;
    EXPECT_GE(static_cast<double>(c.decisions), wanted);
    EXPECT_GT(c.contacts, 0u);
}

// Every course of one kind of meshes, at every scale and near and far, in turn.
void all_courses(Kind kind, double share) {
    const double wanted = share * decisions_wanted();
    Counts counts;
    for (std::uint64_t i = 0; static_cast<double>(counts.decisions) < wanted || i < std::size(courses); ++i) {
        Random random(first_seed() + 1000 * static_cast<std::uint64_t>(kind) + i);
        Episode episode;
        episode.kind = kind;
        episode.course = courses[i % std::size(courses)];
        episode.seed = random.bits();
        constexpr double scales[] = {1, 1e-3, 100, 0.1};
        episode.scale = scales[i % std::size(scales)];
        if (random.below(3) == 0) episode.origin = {-6000, 7000, -4000};
        episode.rounded = random.below(3) == 0;
        episode.together = random.below(5) == 0;
        episode.bodies = kind == Kind::slab ? 24 : 12;
        episode.tightness = random.uniform(0, kind == Kind::slab ? 0.5 : 0.4);
        episode.steps = 120;
        play(episode, counts);
    }
    report(name_of(kind), counts, wanted);
}

TEST(certified, concave_meshes) {
    all_courses(Kind::concave, 0.12);
}
TEST(certified, cavities_and_shells) {
    all_courses(Kind::cavities, 0.05);
}
TEST(certified, open_meshes) {
    all_courses(Kind::open, 0.05);
}
TEST(certified, meshes_that_cross_themselves) {
    all_courses(Kind::crossing, 0.05);
}
TEST(certified, slivers_and_needles) {
    all_courses(Kind::slivers, 0.05);
}
TEST(certified, small_bodies_on_a_large_slab) {
    all_courses(Kind::slab, 0.03);
}
TEST(certified, bodies_of_all_sizes) {
    all_courses(Kind::sizes, 0.05);
}

// Two or three meshes turning in contact for thousands of steps.
TEST(certified, long_spins_in_contact) {
    const double wanted = 0.03 * decisions_wanted();
    Counts counts;
    for (std::uint64_t i = 0; static_cast<double>(counts.decisions) < wanted; ++i) {
        Random random(first_seed() + 100000 + i);
        Episode episode;
        episode.kind = kinds[i % std::size(kinds)];
        episode.course = i % 2 ? Course::spin : Course::drift;
        episode.bodies = 2 + random.below(2);
        episode.tightness = random.uniform(0.1, 0.5);
        episode.steps = 3000;
        episode.rounded = random.below(2) == 0;
        episode.seed = random.bits();
        play(episode, counts);
    }
    report("long spins", counts, wanted);
}

const std::vector<std::shared_ptr<const Shape>>& fine_shapes() {
    static const std::vector<std::shared_ptr<const Shape>> shapes = [] {
        std::vector<std::shared_ptr<const Shape>> list;
        for (const char* kind : {"knot", "gear", "torus", "sphere"})
            list.push_back(Shape::make(scenes::scene_model(kind, 4000).mesh));
        return list;
    }();
    return shapes;
}

// The bulk of the decisions: dense crowds of finer meshes.
TEST(certified, dense_crowds) {
    const double wanted = 0.5 * decisions_wanted();
    Counts counts;
    for (std::uint64_t i = 0; static_cast<double>(counts.decisions) < wanted; ++i) {
        Random random(first_seed() + 200000 + i);
        Settings settings = some_settings(random);
        settings.skip_outside = true;
        Triplet triplet(settings, thresholds[random.below(std::size(thresholds))], "dense crowd " + std::to_string(i));
        std::vector<Mover> movers;
        constexpr std::uint32_t bodies = 40;
        for (std::uint32_t b = 0; b < bodies; ++b) {
            const auto& shape = fine_shapes()[b % fine_shapes().size()];
            Pose home = random.rotation();
            home.translation = 2.2 * random.in_ball();
            triplet.each([&](Scene& scene) { scene.add(shape); });
            movers.emplace_back(i % 2 ? Course::mixed : Course::drift, home, 1.0, random);
        }
        for (int step = 0; step < 150; ++step) {
            for (BodyId b = 0; b < bodies; ++b) {
                const Pose pose = movers[b].next(random);
                triplet.each([&](Scene& scene) { scene.set_pose(b, pose); });
            }
            triplet.step(counts);
        }
        ++counts.episodes;
    }
    report("dense crowds", counts, wanted);
}

// Bodies and pairs come and go, settings change, and the shape store is packed, all in mid-run.
TEST(certified, eventful_scenes) {
    const double wanted = 0.05 * decisions_wanted();
    Counts counts;
    for (std::uint64_t i = 0; static_cast<double>(counts.decisions) < wanted; ++i) {
        Random random(first_seed() + 300000 + i);
        const Settings settings = some_settings(random);
        Triplet triplet(settings, 1e-3, "eventful scene " + std::to_string(i));
        const Kind kind = kinds[random.below(std::size(kinds))];
        const auto& stock = crowd_shapes(kind, 1);
        struct Guest {
            BodyId id;
            Mover mover;
        };
        std::vector<Guest> guests;
        std::vector<Pair> pairs;
        bool given = false;
        const auto add = [&] {
            auto shape = stock[random.below(static_cast<std::uint32_t>(stock.size()))];
            // A shape of its own moves the others in the store when it goes and the store is packed.
            if (random.below(3) == 0) shape = Shape::make(model_mesh("gear"));
            BodyId id = 0;
            triplet.each([&](Scene& scene) { id = scene.add(shape); });
            Pose home = random.rotation();
            home.translation = 1.2 * random.in_ball();
            guests.push_back({id, Mover(Course::mixed, home, 1.0, random)});
        };
        while (guests.size() < 12) add();
        for (int step = 0; step < 200; ++step) {
            for (Guest& guest : guests) {
                const Pose pose = guest.mover.next(random);
                triplet.each([&](Scene& scene) { scene.set_pose(guest.id, pose); });
            }
            if (random.below(8) == 0 && guests.size() < 20) add();
            if (random.below(8) == 0 && guests.size() > 4) {
                const auto gone = guests.begin() + random.below(static_cast<std::uint32_t>(guests.size()));
                triplet.each([&](Scene& scene) { scene.remove(gone->id); });
                std::erase_if(pairs, [&](const Pair& p) { return p.first == gone->id || p.second == gone->id; });
                *gone = guests.back();
                guests.pop_back();
            }
            if (random.below(20) == 0) {
                const Direction direction = random.below(2) ? Direction::ray : Direction::reprojected;
                const bool same = random.below(2) == 0; // all that was kept is dropped even so
                const double threshold = thresholds[random.below(std::size(thresholds))];
                triplet.each([&](Scene& scene) {
                    Settings changed = scene.settings();
                    if (!same) {
                        changed.direction = direction;
                        changed.caster = step % 3 ? Caster::bvh : Caster::basic;
                        if (changed.displacement_threshold) changed.displacement_threshold = threshold;
                    }
                    scene.set_settings(changed);
                });
            }
            if (random.below(10) == 0) given = !given;
            if (given) {
                for (int k = 0; k < 6; ++k) { // pairs appear and disappear, touching or not
                    const BodyId a = guests[random.below(static_cast<std::uint32_t>(guests.size()))].id;
                    const BodyId b = guests[random.below(static_cast<std::uint32_t>(guests.size()))].id;
                    if (a != b) pairs.emplace_back(a, b);
                    if (!pairs.empty() && random.below(2))
                        pairs.erase(pairs.begin() + random.below(static_cast<std::uint32_t>(pairs.size())));
                }
                triplet.step(counts, pairs);
            } else {
                triplet.step(counts);
            }
        }
        ++counts.episodes;
    }
    report("eventful", counts, wanted);
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
            return Shape::make(mesh);
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
    settings.threads = 1;
    Triplet triplet(settings, thresholds[random.below(std::size(thresholds))], "strike " + std::to_string(number));
    const bool first = random.below(2) == 0;
    BodyId of_face = 0, of_vertex = 0;
    triplet.each([&](Scene& scene) {
        of_face = first ? scene.add(target) : 0;
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

TEST(certified, a_vertex_straight_at_a_face) {
    const auto strikes = static_cast<std::uint64_t>(std::max(300.0, 2e-5 * decisions_wanted()));
    Counts counts;
    for (std::uint64_t i = 0; i < strikes; ++i) {
        Random random(first_seed() + 400000 + i);
        strike(random, counts, i);
    }
    report("strikes", counts, 10.0 * static_cast<double>(strikes));
}

// A slab of 42 m whose rotation is one only to 9e-5, anew in each step, and bodies that touch it far from its middle.
TEST(certified, sheared_slab) {
    const double wanted = 0.02 * decisions_wanted();
    Counts counts;
    for (std::uint64_t i = 0; static_cast<double>(counts.decisions) < wanted; ++i) {
        Random random(first_seed() + 500000 + i);
        Episode episode;
        episode.kind = Kind::slab;
        episode.course = i % 4 ? Course::sheared : Course::mixed;
        episode.bodies = 16;
        episode.tightness = random.uniform(0.3, 0.6);
        episode.steps = 200;
        episode.together = i % 3 == 0;
        episode.seed = random.bits();
        play(episode, counts);
    }
    report("sheared slab", counts, wanted);
}

// Bodies that lie flat near the slab's corners, a millimetre deep: there a matrix that is no rotation is off by as
// much.
TEST(certified, flat_bodies_on_a_sheared_slab) {
    Counts counts;
    const auto slab = Shape::make(box_mesh({21, 21, 1}));
    std::vector<std::shared_ptr<const Shape>> shapes;
    for (const Mesh& mesh : {grid_box_mesh(12), l_prism_mesh(), frame_mesh()}) shapes.push_back(Shape::make(mesh));
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
            for (BodyId b = 0; b < homes.size(); ++b) {
                Pose pose = homes[b];
                pose.translation = pose.translation + 1e-3 * random.in_ball();
                if (b > 0 || i % 2) pose = sheared(pose, random);
                triplet.each([&](Scene& scene) { scene.set_pose(b, pose); });
            }
            triplet.step(counts);
        }
        ++counts.episodes;
    }
    report("flat on sheared slab", counts, 1e3);
}

// Shapes that go take others to new places in the store while pairs of those are asleep.
TEST(certified, packed_shapes) {
    Counts counts;
    for (std::uint64_t i = 0; i < 20; ++i) {
        Random random(first_seed() + 600000 + i);
        Triplet triplet(some_settings(random), 1e-2, "packed shapes " + std::to_string(i));
        std::vector<BodyId> ballast(4);
        const auto add = [&](const std::shared_ptr<const Shape>& shape, const Pose& pose) {
            BodyId id = 0;
            triplet.each([&](Scene& scene) { id = scene.add(shape, pose); });
            return id;
        };
        Pose away;
        away.translation = {1000, 0, 0};
        for (std::size_t k = 0; k < ballast.size(); ++k)
            ballast[k] = add(Shape::make(model_mesh(k % 2 ? "gear" : "knot")), away);
        std::vector<std::shared_ptr<const Shape>> shapes;
        for (const Mesh& mesh : {bumpy_octahedron_mesh(5), frame_mesh(), l_prism_mesh(), tetrahedron_mesh()})
            for (int k = 0; k < 2; ++k) shapes.push_back(Shape::make(mesh));
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

// As far apart as finite numbers go, and back.
TEST(certified, beyond_the_range_of_squares) {
    const auto shape = Shape::make(bumpy_octahedron_mesh(5));
    Counts counts;
    for (const double far : {1e30, 1e100, 1e200, 1.7e308})
        for (const bool begin_far : {false, true}) {
            Settings settings;
            settings.threads = 1;
            char what[40];
            std::snprintf(what, sizeof what, "%g m apart", far);
            Triplet triplet(settings, 1e-2, what);
            triplet.each([&](Scene& scene) {
                scene.add(shape);
                scene.add(shape);
            });
            const std::vector<Pair> pair{{0, 1}};
            for (int step = 0; step < 12; ++step) {
                const bool away = (step / 3 % 2 == 0) == begin_far;
                Pose a, b;
                a.translation = {away ? -far : 0.0, 0, 0};
                b.translation = {away ? far : 0.9, away ? far : 0.0, 0};
                triplet.each([&](Scene& scene) {
                    scene.set_pose(0, a);
                    scene.set_pose(1, b);
                });
                triplet.step(counts, pair);
            }
            ++counts.episodes;
        }
    report("very far", counts, 100);
}

// Away together, so far that the doubles of their positions lose how they lay to each other.
TEST(certified, far_away_together) {
    const auto shape = Shape::make(box_mesh({0.5, 0.5, 0.5}));
    Counts counts;
    for (const double far : {1e12, 1e14, 1e15, 1e16, 1e17, 1e30}) {
        Settings settings;
        settings.threads = 1;
        char what[40];
        std::snprintf(what, sizeof what, "together %g m away", far);
        Triplet triplet(settings, 1e-2, what);
        Pose a, b = small_rotation({0, 0, 1}, 0.785);
        triplet.each([&](Scene& scene) {
            scene.add(shape);
            scene.add(shape);
        });
        const std::vector<Pair> pair{{0, 1}};
        for (int step = 0; step < 12; ++step) {
            const double x = step / 3 % 2 == 0 ? 0 : far;
            a.translation = {x, 0, 0};
            b.translation = {x + 2, 0.8, 0.1};
            triplet.each([&](Scene& scene) {
                scene.set_pose(0, a);
                scene.set_pose(1, b);
            });
            triplet.step(counts, pair);
        }
        ++counts.episodes;
    }
    report("far away together", counts, 10);
}

// A rotation that stretches by as much as is accepted makes rays reach farther than their vertices' exit distances say.
TEST(certified, stretched_rays) {
    const auto small = Shape::make(box_mesh({0.5, 0.5, 0.5}));
    Mesh mesh = grid_box_mesh(32); // [0, 1]^3
    for (Vec3& v : mesh.vertices) v = 4.8 * (v - Vec3{0.5, 0.5, 0.5});
    const auto large = Shape::make(mesh);
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
    settings.threads = 1;
    settings.displacement_threshold = 0.1; // no jump is left to the standard method
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
    triplet.each([&](Scene& scene) { scene.set_pose(1, b); });
    const std::vector<Pair> pair{{0, 1}};
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
            triplet.each([&](Scene& scene) { scene.set_pose(0, pose); });
            triplet.step(counts, pair);
        }
    }
    ++counts.episodes;
    report("stretched rays", counts, 1e4);
}

} // namespace
