// SPDX-License-Identifier: Apache-2.0
#include "contacts.h"

#include "geom_shape.h"

#include <raycontact/manifold.h>
#include <raycontact/query.h>
#include <raycontact/scene.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace raycontact::mujoco {

namespace {

// Up to this part of the smaller geom's size a margin has all contacts; beyond it the nearest places alone.
constexpr double largest_margin = 0.1;
// Points nearer to each other than this part of the smaller geom's size are at one place.
constexpr double one_place = 0.01;
// Scenes that a thread keeps: each has what its pair was asked last, which saves work and changes no answer.
constexpr std::size_t most_scenes = 1024; // of some 50 KB each
// Of a capsule's axis, between whose points the nearest places are sought.
constexpr int samples = 16, refinements = 24;

std::atomic<std::uint64_t> calls, told, left_out;

Vec3 plus(const Vec3& a, double s, const Vec3& b) {
    return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
double diagonal(const Shape& shape) {
    const Vec3 size = plus(shape.box_max(), -1, shape.box_min());
    return std::sqrt(size.x * size.x + size.y * size.y + size.z * size.z);
}
Vec3 axis_of(const Pose& pose) {
    return {pose.rotation[2], pose.rotation[5], pose.rotation[8]};
}
bool is_round(const Geom& geom) {
    return geom.kind == Geom::Kind::ball || geom.kind == Geom::Kind::capsule;
}

Point point_of(const ManifoldPoint& found) {
    const auto triple = [](const Vec3& v) { return Triple{v.x, v.y, v.z}; };
    return {-found.depth, triple(found.position), triple(found.normal)};
}

/// Whether the boxes of two shapes are farther apart than this along an axis. MuJoCo asks about geoms whose spheres
/// meet, as things in a bin and its walls.
bool are_apart(const Shape& a, const Pose& at_a, const Shape& b, const Pose& at_b, double by) {
    const AxisBox one = placed_box(a, at_a), two = placed_box(b, at_b);
    const auto apart = [by](double low, double high, double other_low, double other_high) {
        return low > other_high + by || other_low > high + by;
    };
    return apart(one.low.x, one.high.x, two.low.x, two.high.x) || apart(one.low.y, one.high.y, two.low.y, two.high.y)
           || apart(one.low.z, one.high.z, two.low.z, two.high.z);
}

/// Those that stand for all, in an order that puts the most important first.
std::size_t choose(const std::vector<ManifoldPoint>& found, std::span<Point> points) {
    const std::vector<std::uint32_t> chosen = choose_contacts(found, points.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) points[i] = point_of(found[chosen[i]]);
    told += chosen.size();
    left_out += found.size() - chosen.size();
    return chosen.size();
}

/// Geoms' numbers only help to find the scene that was asked about the same geoms.
struct PairKey {
    std::shared_ptr<const Shape> a, b;
    int number_a, number_b;
    bool speculative;
    std::uint32_t most; ///< contacts
    bool operator==(const PairKey&) const = default;
};
struct PairKeyHash {
    std::size_t operator()(const PairKey& key) const {
        std::size_t h = std::hash<const void*>()(key.a.get()) ^ 3 * std::hash<const void*>()(key.b.get());
        return h * 31 + static_cast<std::size_t>(key.number_a) * 65537 + static_cast<std::size_t>(key.number_b);
    }
};

/// Two bodies that wait for their next poses.
struct PairScene {
    PairKey key;
    Scene scene;
    Pair pair;

    static Settings settings(const PairKey& key) {
        Settings settings;
        settings.direction = Direction::refined;
        settings.speculative = key.speculative;
        settings.max_contacts_per_pair = key.most;
        settings.execution.threads = 1;
        settings.execution.devices = "cpu";
        return settings;
    }
    explicit PairScene(const PairKey& of) : key(of), scene(settings(of)), pair{scene.add(of.a), scene.add(of.b)} {}
};

/// The thread's own for a pair; those used last are kept.
PairScene& scene_of(const PairKey& key) {
    thread_local std::list<PairScene> scenes;
    thread_local std::unordered_map<PairKey, std::list<PairScene>::iterator, PairKeyHash> places;
    if (const auto known = places.find(key); known != places.end()) {
        scenes.splice(scenes.begin(), scenes, known->second);
        return scenes.front();
    }
    scenes.emplace_front(key);
    places.emplace(key, scenes.begin());
    if (scenes.size() > most_scenes) {
        places.erase(scenes.back().key);
        scenes.pop_back();
    }
    return scenes.front();
}

std::size_t of_meshes(const Geom& a, const Geom& b, double margin, std::span<Point> points, bool& off_centre) {
    const auto shape_a = shape_of(a, off_centre), shape_b = shape_of(b, off_centre);
    const double size = std::min(diagonal(*shape_a), diagonal(*shape_b));
    const double asked = margin;
    if (are_apart(*shape_a, pose_of(a), *shape_b, pose_of(b), asked)) return 0;
    margin = std::min(margin, largest_margin * size);
    PairScene& own =
        scene_of({shape_a, shape_b, a.number, b.number, margin > 0, static_cast<std::uint32_t>(points.size())});
    const auto& [first, second] = own.pair;
    own.scene.set_pose(first, pose_of(a));
    own.scene.set_pose(second, pose_of(b));
    if (margin > 0) {
        own.scene.set_speculative_margin(first, margin);
        own.scene.set_next_pose(first, pose_of(a)); // where they are: what was asked before says nothing
        own.scene.set_next_pose(second, pose_of(b));
    }
    own.scene.forget_contacts(); // nor which of them it chose
    std::size_t count = 0;
    for (const Contact& c : own.scene.find_contacts({&own.pair, 1})) {
        if (-double(c.depth) >= margin && c.is_speculative()) continue;
        points[count++] = point_of({plus(c.point_a, 0.5, plus(c.point_b, -1, c.point_a)), c.normal, double(c.depth)});
    }
    left_out += own.scene.stats().contacts_reduced;
    if (count == 0 && asked > margin) { // as mj_geomDistance and its sensors ask
        const auto nearest = distance(*shape_a, pose_of(a), *shape_b, pose_of(b), asked);
        if (nearest && nearest->distance > 0 && nearest->distance < asked) {
            const Vec3 way = plus(nearest->point_b, -1, nearest->point_a);
            points[count++] =
                point_of({plus(nearest->point_a, 0.5, way), plus({}, 1 / nearest->distance, way), -nearest->distance});
        }
    }
    told += count;
    return count;
}

/// Where a ball of the round geom `ball` meets the mesh: its point of the axis at `at`.
ManifoldPoint of_ball(const Geom& ball, const SignedDistance& near, const Vec3& centre, bool ball_first) {
    const double radius = ball.size[0], distance = near.distance - radius;
    const Vec3 out = near.gradient; // away from the mesh
    // Half way between the mesh's point and the ball's.
    const Vec3 position = plus(centre, -0.5 * (radius + near.distance), out);
    return {position, plus({}, ball_first ? -1 : 1, out), -distance, any_distance, one_place * radius};
}

std::size_t of_round(const Geom& round, const Geom& mesh, double margin, std::span<Point> points, bool round_first,
                     bool& off_centre) {
    const auto shape = shape_of(mesh, off_centre);
    const Pose at_mesh = pose_of(mesh), at_round = pose_of(round);
    const double half = round.kind == Geom::Kind::capsule ? round.size[1] : 0;
    const Vec3 along = axis_of(at_round);
    const auto place = [&](double at) { return plus(at_round.translation, at, along); };
    const auto near = [&](double at) {
        const Vec3 centre = place(at);
        return signed_distance(*shape, at_mesh, {&centre, 1}, 1)[0];
    };
    std::vector<ManifoldPoint> found;
    const auto add = [&](double at, const SignedDistance& at_place) {
        if (at_place.distance - round.size[0] < margin)
            found.push_back(of_ball(round, at_place, place(at), round_first));
    };
    if (half == 0) {
        add(0, near(0));
        return choose(found, points);
    }
    std::vector<Vec3> centres;
    const auto sample = [&](int i) { return half * (2.0 * i / samples - 1); };
    for (int i = 0; i <= samples; ++i) centres.push_back(place(sample(i)));
    const std::vector<SignedDistance> all = signed_distance(*shape, at_mesh, centres, 1);
    for (int i = 0; i <= samples; ++i) {
        const auto value = [&](int k) { return all[static_cast<std::size_t>(k)].distance; };
        if (i == 0 || i == samples) {
            add(sample(i), all[static_cast<std::size_t>(i)]);
            continue;
        }
        // A place between others that are farther; where the capsule lies flat its ends say it all.
        const double clearly = 1e-6 * round.size[0];
        double low = sample(i - 1), high = sample(i + 1);
        if (!(value(i - 1) > value(i) + clearly) || value(i + 1) < value(i)) continue;
        if (value(i) - (high - low) > round.size[0] + margin) continue; // it changes no faster than the place
        constexpr double golden = 0.6180339887498949;                   // section (Kiefer 1953)
        double p = high - golden * (high - low), q = low + golden * (high - low);
        double at_p = near(p).distance, at_q = near(q).distance;
        for (int k = 0; k < refinements; ++k) {
            if (at_p < at_q) {
                high = std::exchange(q, p);
                at_q = at_p;
                p = high - golden * (high - low);
                at_p = near(p).distance;
            } else {
                low = std::exchange(p, q);
                at_p = at_q;
                q = low + golden * (high - low);
                at_q = near(q).distance;
            }
        }
        const double at = 0.5 * (low + high);
        add(at, near(at));
    }
    return choose(found, points);
}

} // namespace

Counts counts() {
    return {calls, told, left_out};
}

std::size_t find_points(const Geom& a, const Geom& b, double margin, std::span<Point> points, bool& off_centre) {
    ++calls;
    if (points.empty()) return 0;
    if (is_round(a)) return of_round(a, b, margin, points, true, off_centre);
    if (is_round(b)) return of_round(b, a, margin, points, false, off_centre);
    return of_meshes(a, b, margin, points, off_centre);
}

} // namespace raycontact::mujoco
