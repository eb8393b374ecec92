// SPDX-License-Identifier: Apache-2.0
#include <raycontact/scene.h>

#include "broadphase/world_box.h"
#include "executor/float_environment.h"
#include "query/checks.h"
#include "query/shape_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// About the file's vertices of a placed shape, which lie a rounding outside of its own box.
Box box_around(const Shape& shape, const Pose& pose) {
    return world_box({shape.box_min(), shape.box_max()}, pose, rounding_of(shape.data()));
}

// How far along a ray a box begins, metres, not more than that; infinite: it is missed. direction: unit.
double entry_of(const Box& box, const Vec3& origin, const Vec3& direction) {
    double enter = 0, leave = infinite;
    for (std::size_t k = 0; k < 3; ++k) {
        const double o = axis(origin, k), d = axis(direction, k), inverse = 1 / (std::fabs(d) > 1e-20 ? d : 1e-20);
        const double slack = 1e-14 * std::fabs(o);
        const double t0 = (axis(box.low, k) - slack - o) * inverse, t1 = (axis(box.high, k) + slack - o) * inverse;
        enter = std::max(enter, std::min(t0, t1));
        leave = std::min(leave, std::max(t0, t1));
    }
    return enter <= leave * (1 + 1e-14) ? enter * (1 - 1e-14) : infinite;
}

struct Candidate {
    double away; ///< of its box, metres, at most
    BodyId body;
};

// The bodies whose boxes are within `max`, nearest first, and of equally near ones the lowest slot.
template <class Away>
std::vector<Candidate> nearest_boxes(const Scene& scene, const Scene::Wanted& wanted, double max, Away&& away) {
    std::vector<Candidate> candidates;
    for (const BodyId body : scene.bodies()) {
        if (wanted && !wanted(body)) continue;
        const double metres = away(box_around(scene.shape(body), scene.pose(body)));
        if (metres <= max && metres < infinite) candidates.push_back({metres, body});
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& p, const Candidate& q) { return p.away < q.away; });
    return candidates;
}

// The nearest of what ask(body, max) finds on the candidates.
template <class Found, class Ask>
std::optional<Found> nearest_of(std::span<const Candidate> candidates, double max, Ask&& ask) {
    std::optional<Found> nearest;
    for (const Candidate& candidate : candidates) {
        const double most = nearest ? nearest->distance : max;
        if (candidate.away > most) break;
        const auto found = ask(candidate.body, most);
        if (!found) continue;
        const bool nearer = !nearest || found->distance < most;
        if (!nearer && !(candidate.body < nearest->body)) continue;
        nearest.emplace();
        static_cast<std::decay_t<decltype(*found)>&>(*nearest) = *found;
        nearest->body = candidate.body;
    }
    return nearest;
}

std::vector<Candidate> boxes_on_ray(const Scene& scene, const Scene::Wanted& wanted, const Vec3& origin,
                                    const Vec3& direction, double max) {
    check_place(origin, "raycast: the origin");
    check_reach(max, "raycast");
    const Vec3 along = checked_direction(direction);
    return nearest_boxes(scene, wanted, max, [&](const Box& box) { return entry_of(box, origin, along); });
}

} // namespace

std::optional<BodyRayHit> Scene::raycast(const Vec3& origin, const Vec3& direction, double max,
                                         const Wanted& wanted) const {
    const FloatEnvironment environment;
    const auto candidates = boxes_on_ray(*this, wanted, origin, direction, max);
    return nearest_of<BodyRayHit>(candidates, max, [&](BodyId body, double most) {
        return raycontact::raycast(shape(body), pose(body), origin, direction, most);
    });
}

bool Scene::raycast_any(const Vec3& origin, const Vec3& direction, double max, const Wanted& wanted) const {
    const FloatEnvironment environment;
    const auto candidates = boxes_on_ray(*this, wanted, origin, direction, max);
    return std::ranges::any_of(candidates, [&](const Candidate& candidate) {
        return raycontact::raycast_any(shape(candidate.body), pose(candidate.body), origin, direction, max);
    });
}

std::optional<BodyClosestPoint> Scene::closest_point(const Vec3& point, double max, const Wanted& wanted) const {
    const FloatEnvironment environment;
    check_place(point, "closest_point: the point");
    check_reach(max, "closest_point");
    const auto candidates = nearest_boxes(
        *this, wanted, max, [&](const Box& box) { return std::sqrt(box.squared_distance(point)) * (1 - 1e-14); });
    return nearest_of<BodyClosestPoint>(candidates, max, [&](BodyId body, double most) {
        return raycontact::closest_point(shape(body), pose(body), point, most);
    });
}

std::vector<BodyId> Scene::overlaps(const Shape& other, const Pose& place, const Wanted& wanted) const {
    const FloatEnvironment environment;
    check_placed(place, "pose of the mesh");
    const Box box = box_around(other, place);
    std::vector<BodyId> found;
    for (const BodyId body : bodies()) {
        if (wanted && !wanted(body)) continue;
        if (!box_around(shape(body), pose(body)).touches(box)) continue;
        if (intersects(shape(body), pose(body), other, place)) found.push_back(body);
    }
    return found;
}

} // namespace raycontact
