// SPDX-License-Identifier: Apache-2.0
#include <raycontact/scene.h>

#include "broadphase/world_box.h"
#include "executor/float_environment.h"
#include "query/checks.h"
#include "query/shape_pair.h"
#include "query/sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace raycontact {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// The nearest of what is found on bodies, or the first; of equal ones that with the lowest slot.
template <class Found, auto away>
class Nearest {
public:
    explicit Nearest(double max) : max_(max) {}

    double farthest() const { return found_ ? (*found_).*away : max_; }
    template <class Other>
    void add(BodyId body, const std::optional<Other>& other) {
        if (!other) return;
        const bool nearer = !found_ || (*other).*away < farthest();
        if (!nearer && ((*other).*away > farthest() || !(body < found_->body))) return;
        found_.emplace();
        static_cast<Other&>(*found_) = *other;
        found_->body = body;
    }
    const std::optional<Found>& found() const { return found_; }

private:
    double max_; ///< metres, or a time
    std::optional<Found> found_;
};

/// A ray that is sound, and how far it looks.
struct CheckedRay {
    Vec3 origin, along;
    double max;
    CheckedRay(const Vec3& from, const Vec3& direction, double most) : origin(from), max(most) {
        check_place(origin, "raycast: the origin");
        check_reach(max, "raycast");
        along = checked_direction(direction);
    }
    double away(const Vec3& low, const Vec3& high) const { return entry_of({low, high}, origin, along); }
};

double away_from(const Vec3& point, const Vec3& low, const Vec3& high) {
    return std::sqrt(Box{low, high}.squared_distance(point)) * (1 - 1e-14);
}

} // namespace

std::optional<BodyRayHit> Scene::raycast(const Vec3& origin, const Vec3& direction, double max,
                                         const Wanted& wanted) const {
    const FloatEnvironment environment;
    const CheckedRay ray(origin, direction, max);
    Nearest<BodyRayHit, &RayHit::distance> nearest(max);
    const auto ask = [&](BodyId body) {
        if (wanted && !wanted(body)) return;
        const Box box = box_around(shape(body), pose(body)); // may be tighter than the tree's
        if (ray.away(box.low, box.high) > nearest.farthest()) return;
        nearest.add(body, raycontact::raycast(shape(body), pose(body), origin, direction, nearest.farthest()));
    };
    visit_near([&](const Vec3& low, const Vec3& high) { return ray.away(low, high); },
               [&] { return nearest.farthest(); }, ask);
    return nearest.found();
}

std::vector<BodyRayHit> Scene::raycast_all(const Vec3& origin, const Vec3& direction, double max,
                                           const Wanted& wanted) const {
    const FloatEnvironment environment;
    const CheckedRay ray(origin, direction, max);
    std::vector<BodyRayHit> found;
    visit_near([&](const Vec3& low, const Vec3& high) { return ray.away(low, high); }, [&] { return max; },
               [&](BodyId body) {
                   if (wanted && !wanted(body)) return;
                   if (const auto hit = raycontact::raycast(shape(body), pose(body), origin, direction, max))
                       found.push_back({*hit, body});
               });
    std::ranges::sort(found, [](const BodyRayHit& a, const BodyRayHit& b) {
        return a.distance < b.distance || (a.distance == b.distance && a.body < b.body);
    });
    return found;
}

bool Scene::raycast_any(const Vec3& origin, const Vec3& direction, double max, const Wanted& wanted) const {
    const FloatEnvironment environment;
    const CheckedRay ray(origin, direction, max);
    bool any = false;
    const auto ask = [&](BodyId body) {
        if (wanted && !wanted(body)) return;
        any = raycontact::raycast_any(shape(body), pose(body), origin, direction, max);
    };
    visit_near([&](const Vec3& low, const Vec3& high) { return ray.away(low, high); },
               [&] { return any ? -infinite : max; }, ask);
    return any;
}

std::optional<BodyClosestPoint> Scene::closest_point(const Vec3& point, double max, const Wanted& wanted) const {
    const FloatEnvironment environment;
    check_place(point, "closest_point: the point");
    check_reach(max, "closest_point");
    Nearest<BodyClosestPoint, &ClosestPoint::distance> nearest(max);
    const auto ask = [&](BodyId body) {
        if (wanted && !wanted(body)) return;
        const Box box = box_around(shape(body), pose(body)); // may be tighter than the tree's
        if (away_from(point, box.low, box.high) > nearest.farthest()) return;
        nearest.add(body, raycontact::closest_point(shape(body), pose(body), point, nearest.farthest()));
    };
    visit_near([&](const Vec3& low, const Vec3& high) { return away_from(point, low, high); },
               [&] { return nearest.farthest(); }, ask);
    return nearest.found();
}

AxisBox placed_box(const Shape& shape, const Pose& pose) {
    const Box box = box_around(shape, pose);
    return {box.low, box.high};
}

// Calls met(body) for those that meet the shape, until it returns false.
template <class Met>
void Scene::visit_overlaps(const Shape& other, const Pose& place, const Wanted& wanted, Met&& met) const {
    const FloatEnvironment environment;
    check_placed(place, "pose of the mesh");
    const Box box = box_around(other, place);
    bool goes_on = true;
    visit_near(
        [&](const Vec3& low, const Vec3& high) {
            return box.touches({low, high}) ? 0 : infinite;
        },
        [&] { return goes_on ? 0 : -infinite; },
        [&](BodyId body) {
            if (!goes_on || (wanted && !wanted(body))) return;
            if (!box_around(shape(body), pose(body)).touches(box)) return;
            if (intersects(shape(body), pose(body), other, place)) goes_on = met(body);
        });
}

std::vector<BodyId> Scene::overlaps(const Shape& other, const Pose& place, const Wanted& wanted) const {
    std::vector<BodyId> found;
    visit_overlaps(other, place, wanted, [&](BodyId body) {
        found.push_back(body);
        return true;
    });
    std::ranges::sort(found, {}, &BodyId::slot);
    return found;
}

// A body far along the way costs as much as a near one. So bodies are asked in the order of the times at which their
// boxes are met: those of the start, which may end the search, then those of longer and longer parts of the way.
std::optional<BodyImpact> Scene::sweep(const Shape& other, const RigidMotion& motion, double distance,
                                       const Wanted& wanted) const {
    const FloatEnvironment environment;
    const Sweep sweep(other, motion, distance);
    Nearest<BodyImpact, &Impact::time> nearest(1);
    std::vector<std::pair<double, BodyId>> due;
    const auto list_due = [&](double after, double until) {
        due.clear();
        visit_near(
            [&](const Vec3& low, const Vec3& high) {
                return sweep.earliest({low, high});
            },
            [&] { return until; },
            [&](BodyId body) {
                const double begin = sweep.earliest(box_around(shape(body), pose(body)));
                if (begin > after && begin <= until && (!wanted || wanted(body))) due.emplace_back(begin, body);
            });
        std::ranges::sort(due);
    };
    const auto go = [&] {
        for (const auto& [begin, body] : due)
            nearest.add(body, sweep.on_the_way(shape(body), pose(body), begin, nearest.farthest()));
    };
    list_due(-1, 0);
    for (const auto& [begin, body] : due) { // by slot
        nearest.add(body, sweep.at_start(shape(body), pose(body)));
        if (nearest.found()) return nearest.found();
    }
    go();
    for (double after = 0; after < nearest.farthest();) {
        const double until = std::min(std::max(4 * after, 1.0 / 16), nearest.farthest());
        list_due(after, until);
        go();
        after = until;
    }
    return nearest.found();
}

std::vector<BodyImpact> Scene::sweep_all(const Shape& other, const RigidMotion& motion, double distance,
                                         const Wanted& wanted) const {
    const FloatEnvironment environment;
    const Sweep sweep(other, motion, distance);
    std::vector<BodyImpact> found;
    visit_near(
        [&](const Vec3& low, const Vec3& high) {
            return sweep.earliest({low, high});
        },
        [] { return 1.0; },
        [&](BodyId body) {
            if (wanted && !wanted(body)) return;
            const double begin = sweep.earliest(box_around(shape(body), pose(body)));
            auto impact = begin <= 0 ? sweep.at_start(shape(body), pose(body)) : std::nullopt;
            if (!impact) impact = sweep.on_the_way(shape(body), pose(body), begin, 1);
            if (impact) found.push_back({*impact, body});
        });
    std::ranges::sort(found, [](const BodyImpact& a, const BodyImpact& b) {
        return a.time < b.time || (a.time == b.time && a.body < b.body);
    });
    return found;
}

bool Scene::overlaps_any(const Shape& other, const Pose& place, const Wanted& wanted) const {
    bool any = false;
    visit_overlaps(other, place, wanted, [&](BodyId) {
        any = true;
        return false;
    });
    return any;
}

} // namespace raycontact
