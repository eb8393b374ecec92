// SPDX-License-Identifier: Apache-2.0
#include "round/round_contacts.h"

#include "mesh/vector.h"
#include "round/first_touches.h"

#include <algorithm>
#include <map>
#include <utility>

namespace raycontact {

namespace {

/// Cosine from which on what is near now is what is touched then.
constexpr double alike_from = 0.9, same_from = 1 - 1e-6;

/// A sine, and a part of the radius. To what lies on something, what comes at a smaller angle and would be passed by
/// less, as the next facet of a bowl, is not told before it is near: the solver would brake it for what carries it.
constexpr double glancing = 0.1, shallow = 0.05;

} // namespace

// Axes and diagonals lie well inside of a side each.
int place_of(int part, const Vec3& normal, int number) {
    constexpr double beside = 0.38; // sine of 22.5 degrees
    const auto third = [](double x) { return x > beside ? 2 : x < -beside ? 0 : 1; };
    const int side = third(normal.x) + 3 * third(normal.y) + 9 * third(normal.z);
    return side + 27 * part + 81 * number;
}

void round_contacts(const Round& round, const Pose& pose, const std::optional<Pose>& next,
                    std::span<const Obstacle> obstacles, double reach, std::vector<RoundContact>& out) {
    out.clear();
    Surroundings surroundings(round, pose, next, obstacles, reach);
    std::vector<Spot> near;
    std::vector<FirstTouch> touched;
    surroundings.spots(0, round.radius + reach, near);
    const auto world_normal = [&](const Spot& spot) {
        return rotated(surroundings.sites()[spot.obstacle].pose.rotation, spot.normal);
    };
    const auto contact = [&](const Spot& spot, int place, const Vec3& point, double distance) {
        const Pose& frame = surroundings.sites()[spot.obstacle].pose;
        return RoundContact{.obstacle = spot.obstacle,
                            .place = place,
                            .point = transform_point(frame, point),
                            .normal = world_normal(spot),
                            .distance = distance,
                            .triangle = spot.triangle,
                            .name = spot.name};
    };
    // By the plane of the touch, below the place of the axis that comes there: a push there does not turn a ball.
    const auto later = [&](const Spot& spot, int place) {
        const Site& site = surroundings.sites()[spot.obstacle];
        const Vec3 centre = (1 - spot.at) * site.start[0] + spot.at * site.start[1];
        const double height = dot(spot.normal, centre - spot.point);
        RoundContact c = contact(spot, place, centre - height * spot.normal, std::max(height - round.radius, 0.0));
        c.is_later = true;
        return c;
    };
    // Of those of an obstacle, the how manyth of its place.
    std::map<std::pair<std::size_t, int>, int> counted;
    const auto place = [&](const Spot& spot) {
        const int first = place_of(spot.part, spot.normal, 0);
        return place_of(spot.part, spot.normal, counted[{spot.obstacle, first}]++);
    };
    std::vector<char> passed(near.size(), 0), told;
    if (next) {
        for (std::size_t i = 0; i < near.size(); ++i) {
            const Spot& spot = near[i];
            const Vec3 way = surroundings.way(spot.obstacle, spot.at);
            passed[i] = spot.away > round.radius && dot(way, spot.normal) < round.radius - spot.away
                        && leads_into(way, spot.normal);
        }
        if (!find_first_touches(surroundings, touched)) passed.assign(near.size(), 0); // its end is not known
    }
    told.assign(touched.size(), 0);
    const auto index_of = [&](const FirstTouch& t) { return static_cast<std::size_t>(&t - touched.data()); };
    std::vector<Vec3> dropped; // normals of what was passed and is not touched there
    bool any_kept = false;
    for (std::size_t i = 0; i < near.size(); ++i) {
        const Spot& spot = near[i];
        const int own = place(spot);
        const auto then = std::ranges::find_if(touched, [&](const FirstTouch& t) {
            return !told[index_of(t)] && t.spot.obstacle == spot.obstacle && t.spot.part == spot.part
                   && dot(t.spot.normal, spot.normal) >= (passed[i] ? alike_from : same_from);
        });
        if (then != touched.end()) told[index_of(*then)] = 1;
        any_kept = any_kept || !passed[i] || then != touched.end();
        if (!passed[i])
            out.push_back(contact(spot, own, spot.point, spot.away - round.radius));
        else if (then != touched.end())
            out.push_back(later(then->spot, own));
        else
            dropped.push_back(world_normal(spot));
    }
    counted.clear();
    for (const FirstTouch& t : touched) {
        if (told[index_of(t)]) continue;
        // What it passes above a tile it touches on the next: the same surface.
        const bool goes_on = std::ranges::any_of(
            dropped, [&](const Vec3& normal) { return dot(normal, world_normal(t.spot)) >= alike_from; });
        const bool skims = any_kept && !goes_on && t.into < glancing * t.length && t.into < shallow * round.radius;
        if (!skims) out.push_back(later(t.spot, coming + place(t.spot)));
    }
    std::ranges::stable_sort(out, {}, &RoundContact::obstacle);
}

} // namespace raycontact
