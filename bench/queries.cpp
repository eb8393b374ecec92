// SPDX-License-Identifier: Apache-2.0
// intersects() and distance() beside FCL's collide() (no contacts, one is enough) and distance() on the same poses, one
// thread, by turns: processor time a query, medians over the rounds, and ratios. Each answers the same questions, and
// how often the answers differ is printed. Then time_of_impact(), as a multiple of one distance(), beside FCL's
// continuousCollide().
#include "bench/commands.h"
#include "bench/options.h"

#include <scenes/models/model.h>
#include <scenes/peers/clock.h>
#include <tests/reference/random.h>

#include <raycontact/query.h>

#ifdef RAYCONTACT_HAS_FCL
#include <fcl/fcl.h>
#endif

#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace raycontact::bench {

namespace {

struct PosedPair {
    Pose a, b;
};

/// Pairs of two meshes of 1 m, turned at random, whose middles are `near` to `far` metres apart.
std::vector<PosedPair> poses(std::size_t count, double near, double far) {
    reference::Random random(1);
    std::vector<PosedPair> pairs;
    for (std::size_t i = 0; i < count; ++i) {
        PosedPair pair{random.rotation(), random.rotation()};
        const Vec3 way = random.direction();
        const double apart = random.uniform(near, far);
        pair.b.translation = {apart * way.x, apart * way.y, apart * way.z};
        pairs.push_back(pair);
    }
    return pairs;
}

/// One way to ask all pairs; the answers of one round.
struct Query {
    std::string name;
    std::function<double(const PosedPair&)> ask;
    std::vector<double> answers{}, microseconds{};
};

void measure(std::vector<Query>& queries, const std::vector<PosedPair>& pairs, std::size_t rounds) {
    for (std::size_t round = 0; round <= rounds; ++round) // the first warms up
        for (Query& query : queries) {
            query.answers.clear();
            const double begin = peers::now().cpu;
            for (const PosedPair& pair : pairs) query.answers.push_back(query.ask(pair));
            const double end = peers::now().cpu;
            if (round > 0) query.microseconds.push_back((end - begin) / static_cast<double>(pairs.size()));
        }
}

#ifdef RAYCONTACT_HAS_FCL
template <class Volume>
std::shared_ptr<fcl::BVHModel<Volume>> model_of(const Shape& shape) {
    std::vector<fcl::Vector3d> points;
    for (const Vec3& v : shape.file_vertices()) points.emplace_back(v.x, v.y, v.z);
    std::vector<fcl::Triangle> triangles;
    for (const auto& t : shape.triangles()) triangles.emplace_back(t[0], t[1], t[2]);
    auto model = std::make_shared<fcl::BVHModel<Volume>>();
    model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(points.size()));
    model->addSubModel(points, triangles);
    model->endModel();
    return model;
}

fcl::Transform3d transform_of(const Pose& pose) {
    fcl::Transform3d transform = fcl::Transform3d::Identity();
    for (int i = 0; i < 9; ++i) transform.linear()(i / 3, i % 3) = pose.rotation[static_cast<std::size_t>(i)];
    transform.translation() = fcl::Vector3d(pose.translation.x, pose.translation.y, pose.translation.z);
    return transform;
}
#endif

double differing(const std::vector<double>& p, const std::vector<double>& q, double by) {
    double count = 0;
    for (std::size_t i = 0; i < p.size(); ++i) count += std::fabs(std::max(p[i], 0.0) - std::max(q[i], 0.0)) > by;
    return count;
}

/// Times are multiples of that of the first query; the answers after that of `truth` are compared with it, and count
/// where they differ by more than `by`.
void compare(const std::string& what, std::vector<Query>& queries, const std::vector<PosedPair>& pairs,
             std::size_t rounds, std::size_t truth = 0, double by = 1e-6) {
    measure(queries, pairs, rounds);
    const double ours = peers::median(queries[0].microseconds);
    for (const Query& query : queries) {
        const double theirs = peers::median(query.microseconds);
        std::printf("%-34s %-28s %9.2f us", what.c_str(), query.name.c_str(), theirs);
        const auto number = static_cast<std::size_t>(&query - queries.data());
        if (number > 0) std::printf("   %7.2f times the first", theirs / ours);
        if (number > truth) std::printf(", %.0f answers differ", differing(queries[truth].answers, query.answers, by));
        std::printf("\n");
    }
    std::fflush(stdout);
}

void compare_meshes(const char* kind, std::uint32_t triangles, std::size_t pair_count, std::size_t rounds) {
    const auto a = Shape::make(scenes::scene_model(kind, triangles).mesh);
    const auto b = Shape::make(scenes::scene_model("knot", triangles).mesh);
#ifdef RAYCONTACT_HAS_FCL
    const auto fcl_a = model_of<fcl::OBBRSSd>(*a), fcl_b = model_of<fcl::OBBRSSd>(*b);
#endif
    struct Distances {
        const char* name;
        double near, far;
    };
    for (const Distances& range :
         {Distances{"deep", 0, 0.2}, Distances{"near", 0.5, 1.0}, Distances{"apart", 1.2, 3}}) {
        const auto pairs = poses(pair_count, range.near, range.far);
        const std::string what = std::string(kind) + " " + std::to_string(triangles) + " " + range.name;
        std::vector<Query> touch{{"intersects", [&](const PosedPair& p) { return intersects(*a, p.a, *b, p.b); }}};
        std::vector<Query> far{{"distance", [&](const PosedPair& p) { return distance(*a, p.a, *b, p.b)->distance; }}};
#ifdef RAYCONTACT_HAS_FCL
        touch.push_back({"fcl::collide OBBRSS", [&](const PosedPair& p) {
                             const fcl::CollisionRequestd request(1, false);
                             fcl::CollisionResultd result;
                             return double(fcl::collide(fcl_a.get(), transform_of(p.a), fcl_b.get(), transform_of(p.b),
                                                        request, result)
                                           > 0);
                         }});
        far.push_back({"fcl::distance OBBRSS", [&](const PosedPair& p) {
                           const fcl::DistanceRequestd request(true);
                           fcl::DistanceResultd result;
                           return fcl::distance(fcl_a.get(), transform_of(p.a), fcl_b.get(), transform_of(p.b), request,
                                                result);
                       }});
#endif
        compare(what, touch, pairs, rounds);
        compare(what, far, pairs, rounds);
    }
}

/// The second mesh flies to where the other answers begin, and turns on the way. The yardstick is one distance() of
/// the first poses. Answers are times; 2 where nothing is met.
void compare_motions(const char* kind, std::uint32_t triangles, std::size_t pair_count, std::size_t rounds) {
    const auto a = Shape::make(scenes::scene_model(kind, triangles).mesh);
    const auto b = Shape::make(scenes::scene_model("knot", triangles).mesh);
#ifdef RAYCONTACT_HAS_FCL
    const auto fcl_a = model_of<fcl::OBBRSSd>(*a), fcl_b = model_of<fcl::OBBRSSd>(*b);
#endif
    const auto begin = poses(pair_count, 1.2, 3), end = poses(pair_count, 0, 1);
    struct Motion {
        const char* name;
        bool turns;
    };
    for (const Motion& motion : {Motion{"straight", false}, Motion{"turning", true}}) {
        const auto goal = [&](const PosedPair& from) {
            const PosedPair& to = end[static_cast<std::size_t>(&from - begin.data())];
            Pose pose = motion.turns ? to.b : from.b;
            pose.translation = {to.b.translation.x - 0.3 * from.b.translation.x,
                                to.b.translation.y - 0.3 * from.b.translation.y,
                                to.b.translation.z - 0.3 * from.b.translation.z};
            return pose;
        };
        std::vector<Query> queries{
            {"distance", [&](const PosedPair& p) { return distance(*a, p.a, *b, p.b)->distance; }}};
        const std::string what = std::string(kind) + " " + std::to_string(triangles) + " " + motion.name;
        queries.push_back({"time_of_impact", [&](const PosedPair& p) {
                               const auto met = time_of_impact(*a, no_motion(p.a), *b, straight_motion(p.b, goal(p)));
                               return met ? met->time : 2;
                           }});
#ifdef RAYCONTACT_HAS_FCL
        // Its conservative advancement finds no impact of such models; this looks at a thousand times.
        queries.push_back({"fcl::continuousCollide, 1000", [&](const PosedPair& p) {
                               const fcl::ContinuousCollisionRequestd request(1000, 1e-4, fcl::CCDM_LINEAR,
                                                                              fcl::GST_LIBCCD, fcl::CCDC_NAIVE);
                               fcl::ContinuousCollisionResultd result;
                               fcl::continuousCollide(fcl_a.get(), transform_of(p.a), transform_of(p.a), fcl_b.get(),
                                                      transform_of(p.b), transform_of(goal(p)), request, result);
                               return result.is_collide ? result.time_of_contact : 2;
                           }});
#endif
        compare(what, queries, begin, rounds, 1, 2e-3);
    }
}

/// What a signed distance takes: of points at random in the mesh's box, of a grid there, and of single ones.
void measure_points(const char* kind, std::uint32_t triangles, std::size_t rounds) {
    const auto shape = Shape::make(scenes::scene_model(kind, triangles).mesh);
    const Vec3 low = shape->box_min(), high = shape->box_max();
    constexpr int side = 40;
    std::vector<Vec3> anywhere, grid;
    reference::Random random(2);
    for (int i = 0; i < side * side * side; ++i) {
        const auto at = [&](int k) { return (k + 0.5) / side; };
        const auto place = [&](double x, double y, double z) {
            return Vec3{low.x + x * (high.x - low.x), low.y + y * (high.y - low.y), low.z + z * (high.z - low.z)};
        };
        anywhere.push_back(place(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)));
        grid.push_back(place(at(i % side), at(i / side % side), at(i / side / side)));
    }
    const auto ask = [&](const char* name, const std::vector<Vec3>& points, auto&& query) {
        std::vector<double> microseconds;
        for (std::size_t round = 0; round < rounds; ++round) {
            const double begin = peers::now().cpu;
            query(points);
            microseconds.push_back((peers::now().cpu - begin) / double(points.size()));
        }
        const std::string what = std::string(kind) + " " + std::to_string(triangles);
        std::printf("%-34s %-28s %9.2f us\n", what.c_str(), name, peers::median(microseconds));
    };
    const auto together = [&](std::span<const Vec3> points) {
        static_cast<void>(signed_distance(*shape, {}, points, 1));
    };
    ask("signed_distance, anywhere", anywhere, together);
    ask("signed_distance, grid", grid, together);
    ask("closest_point, contains", std::vector(anywhere.begin(), anywhere.begin() + 4000),
        [&](std::span<const Vec3> points) {
            for (const Vec3& p : points) {
                static_cast<void>(closest_point(*shape, {}, p));
                static_cast<void>(contains(*shape, p));
            }
        });
}

} // namespace

void add_queries(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "queries", "intersects(), distance() and time_of_impact() beside FCL on the same poses, by turns, with ratios; "
                   "signed_distance()");
    struct Options {
        std::size_t rounds = 7, pairs = 200;
    };
    auto options = std::make_shared<Options>();
    add_number(*command, "--rounds", options->rounds, "by turns; medians count", std::size_t{1}, std::size_t{1000});
    add_number(*command, "--pairs", options->pairs, "poses of two meshes each", std::size_t{1}, std::size_t{1000000});
    command->callback([options] {
        for (const std::uint32_t triangles : {1000u, 20000u})
            for (const char* kind : {"sphere", "gear"})
                compare_meshes(kind, triangles, options->pairs, options->rounds);
        for (const std::uint32_t triangles : {1000u, 20000u})
            for (const char* kind : {"sphere", "gear"})
                compare_motions(kind, triangles, options->pairs, options->rounds);
        for (const std::uint32_t triangles : {1000u, 10000u})
            for (const char* kind : {"sphere", "gear"}) measure_points(kind, triangles, options->rounds);
    });
}

} // namespace raycontact::bench
