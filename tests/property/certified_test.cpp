// SPDX-License-Identifier: Apache-2.0
// The certified method gives the contacts of the standard method, bit for bit, whatever the meshes and however they
// move: crowds of all kinds. certified_cases_test.cpp has what crowds do not come to.
#include "prepared_shape.h"
#include "property/crowds.h"
#include "property/shapes.h"
#include "property/triplet.h"
#include "reference/vector.h"
#include "scenes/models/model.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <iterator>
#include <string>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

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
    Features features = Features::edges;

    std::string name() const {
        char text[200];
        std::snprintf(text, sizeof text, "%s, %s, scale %g, %g m from the origin%s%s, seed %llu", name_of(kind),
                      name_of(course), scale, length(origin), rounded ? ", rounded" : "",
                      together ? ", all together" : "", static_cast<unsigned long long>(seed));
        return text;
    }
};

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

    Settings settings = some_settings(random);
    settings.features = episode.features;
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
        for (std::uint32_t body = 0; body < episode.bodies; ++body) {
            Pose pose = composed(frame, movers[body].next(random));
            if (episode.rounded) pose = rounded_to_float(pose);
            triplet.each([&](Scene& scene) { scene.set_pose({body}, pose); });
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
        if (random.below(8) != 0)
            episode.features = Features::vertices; // edges of coarse meshes take ten times as long
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

TEST(certified, coarse_meshes) {
    all_courses(Kind::coarse, 0.005);
}

// Of every kind, coarse and fine: edges' contacts are asked of the same vertices' contacts, so they are the same, too.
TEST(certified, edges) {
    const double wanted = 0.005 * decisions_wanted();
    Counts counts;
    for (std::uint64_t i = 0; static_cast<double>(counts.decisions) < wanted || i < 2 * std::size(kinds); ++i) {
        Random random(first_seed() + 600000 + i);
        Episode episode;
        episode.kind = i % 2 ? Kind::coarse : kinds[i / 2 % std::size(kinds)];
        episode.course = courses[random.below(std::size(courses))];
        episode.bodies = 12;
        episode.tightness = random.uniform(0, 0.4);
        episode.steps = 60;
        episode.rounded = random.below(3) == 0;
        episode.together = random.below(5) == 0;
        episode.seed = random.bits();
        episode.features = Features::edges;
        play(episode, counts);
    }
    report("with edges", counts, wanted);
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
            list.push_back(prepared_shape(scenes::scene_model(kind, 4000).mesh));
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
        settings.paper.skip_outside = true;
        settings.features = i % 4 ? Features::vertices : Features::edges;
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
            for (std::uint32_t b = 0; b < bodies; ++b) {
                const Pose pose = movers[b].next(random);
                triplet.each([&](Scene& scene) { scene.set_pose({b}, pose); });
            }
            triplet.step(counts);
        }
        ++counts.episodes;
    }
    report("dense crowds", counts, wanted);
}

// Fine meshes that just touch, at paces between which normal-cone balls come to be asked and cease to be (0.25 % of the
// size).
TEST(certified, fine_meshes_that_creep) {
    const double wanted = 0.05 * decisions_wanted();
    Counts counts;
    for (std::uint64_t i = 0; static_cast<double>(counts.decisions) < wanted; ++i) {
        Random random(first_seed() + 400000 + i);
        Triplet triplet(soon_directed(some_settings(random)), thresholds[random.below(std::size(thresholds))],
                        "creeping " + std::to_string(i));
        std::vector<std::shared_ptr<const Shape>> shapes;
        for (std::uint32_t b = 0; b < 8; ++b)
            shapes.push_back(fine_shapes()[random.below(static_cast<std::uint32_t>(fine_shapes().size()))]);
        const std::vector<Pose> homes = touching_poses(shapes, random.uniform(0, 0.02), random);
        for (const auto& shape : shapes) triplet.each([&](Scene& scene) { scene.add(shape); });
        std::vector<Mover> movers;
        movers.reserve(homes.size());
        for (const Pose& home : homes) movers.emplace_back(Course::creep, home, 1.0, random);
        for (int step = 0; step < 50; ++step) {
            for (std::uint32_t b = 0; b < movers.size(); ++b) {
                const Pose pose = movers[b].next(random);
                triplet.each([&](Scene& scene) { scene.set_pose({b}, pose); });
            }
            triplet.step(counts);
        }
        ++counts.episodes;
    }
    report("creeping", counts, wanted);
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
            if (random.below(3) == 0) shape = prepared_shape(model_mesh("gear"));
            BodyId id;
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
                const Direction direction = directions[random.below(static_cast<std::uint32_t>(std::size(directions)))];
                const bool same = random.below(2) == 0; // all that was kept is dropped even so
                const double threshold = thresholds[random.below(std::size(thresholds))];
                triplet.each([&](Scene& scene) {
                    Settings changed = scene.settings();
                    if (!same) {
                        changed.direction = direction;
                        changed.paper.caster = step % 3 ? Caster::bvh : Caster::basic;
                        if (changed.paper.displacement_threshold) changed.paper.displacement_threshold = threshold;
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

} // namespace
