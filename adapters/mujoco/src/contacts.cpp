// SPDX-License-Identifier: Apache-2.0
#include "contacts.h"

#include "geom_shape.h"

#include <raycontact/query.h>
#include <raycontact/scene.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <list>
#include <memory>
#include <unordered_map>

namespace raycontact::mujoco {

namespace {

// Up to this part of the smaller geom's size a margin has all contacts; beyond it the nearest places alone.
constexpr double largest_margin = 0.1;
// Scenes that a thread keeps: each has what its pair was asked last, which saves work and changes no answer.
constexpr std::size_t most_scenes = 1024; // of some 50 KB each

std::atomic<std::uint64_t> calls, told, left_out;

double diagonal(const Shape& shape) {
    return length(shape.box_max() - shape.box_min());
}

/// Half way between the surfaces.
Point point_of(const Vec3& point_a, const Vec3& point_b, const Vec3& normal, double distance) {
    const Vec3 middle = 0.5 * (point_a + point_b);
    return {distance, {middle.x, middle.y, middle.z}, {normal.x, normal.y, normal.z}};
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
        settings.speculative = key.speculative ? Speculative::on : Speculative::off;
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

} // namespace

Counts counts() {
    return {calls, told, left_out};
}

std::size_t find_points(const Geom& a, const Geom& b, double margin, std::span<Point> points, bool& off_centre) {
    ++calls;
    if (points.empty()) return 0;
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
        points[count++] = point_of(c.point_a, c.point_b, c.normal, -double(c.depth));
    }
    left_out += own.scene.stats().contacts_reduced;
    if (count == 0 && asked > margin) { // as mj_geomDistance and its sensors ask
        const auto nearest = distance(*shape_a, pose_of(a), *shape_b, pose_of(b), asked);
        if (nearest && nearest->distance > 0 && nearest->distance < asked)
            points[count++] = point_of(nearest->point_a, nearest->point_b,
                                       (nearest->point_b - nearest->point_a) / nearest->distance, nearest->distance);
    }
    told += count;
    return count;
}

} // namespace raycontact::mujoco
