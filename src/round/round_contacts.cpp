// SPDX-License-Identifier: Apache-2.0
#include "round/round_contacts.h"

#include "mesh/vector.h"
#include "round/first_touches.h"

#include <algorithm>
#include <array>

namespace raycontact {

namespace {

/// Cosine from which on what is near now is what is touched then.
constexpr double alike_from = 0.9, same_from = 1 - 1e-6;

/// A sine, and a part of the radius. To what lies on something, what comes at a smaller angle and would be passed by
/// less, as the next facet of a bowl, is not told before it is near: the solver would brake it for what carries it.
constexpr double glancing = 0.1, shallow = 0.05;

} // namespace

void round_contacts(const Round& round, const Pose& pose, const std::optional<Pose>& next,
                    std::span<const Obstacle> obstacles, double reach, std::vector<RoundContact>& out) {
    out.clear();
    Surroundings surroundings(round, pose, next, obstacles, reach);
    std::vector<Spot> near;
    std::vector<FirstTouch> touched;
    surroundings.spots(0, round.radius + reach, near);
    const auto contact = [&](const Spot& spot, int place, const Vec3& point, double distance) {
        const Pose& frame = surroundings.sites()[spot.obstacle].pose;
        return RoundContact{
            spot.obstacle, place,    transform_point(frame, point), rotated(frame.rotation, spot.normal), distance,
            spot.triangle, spot.name};
    };
    // By the plane of the touch, below the place of the axis that comes there: a push there does not turn a ball.
    const auto later = [&](const Spot& spot, int place) {
        const Site& site = surroundings.sites()[spot.obstacle];
        const Vec3 centre = (1 - spot.at) * site.start[0] + spot.at * site.start[1];
        const double height = dot(spot.normal, centre - spot.point);
        return contact(spot, place, centre - height * spot.normal, std::max(height - round.radius, 0.0));
    };
    std::vector<char> passed(near.size(), 0), told;
    if (next) {
        for (std::size_t i = 0; i < near.size(); ++i)
            passed[i] =
                near[i].away > round.radius
                && dot(surroundings.way(near[i].obstacle, near[i].at), near[i].normal) < round.radius - near[i].away;
        if (!find_first_touches(surroundings, touched)) passed.assign(near.size(), 0); // its end is not known
    }
    told.assign(touched.size(), 0);
    const auto index_of = [&](const FirstTouch& t) { return static_cast<std::size_t>(&t - touched.data()); };
    std::array<int, 3> count{};
    for (std::size_t i = 0; i < near.size(); ++i) {
        const Spot& spot = near[i];
        if (i == 0 || near[i - 1].obstacle != spot.obstacle) count = {};
        const int place = spot.part + 3 * count[static_cast<std::size_t>(spot.part)]++;
        const auto then = std::ranges::find_if(touched, [&](const FirstTouch& t) {
            return !told[index_of(t)] && t.spot.obstacle == spot.obstacle && t.spot.part == spot.part
                   && dot(t.spot.normal, spot.normal) >= (passed[i] ? alike_from : same_from);
        });
        if (then != touched.end()) told[index_of(*then)] = 1;
        if (!passed[i])
            out.push_back(contact(spot, place, spot.point, spot.away - round.radius));
        else if (then != touched.end())
            out.push_back(later(then->spot, place));
    }
    count = {};
    for (const FirstTouch& t : touched) {
        const bool skims = !near.empty() && t.into < glancing * t.length && t.into < shallow * round.radius;
        if (told[index_of(t)] || skims) continue;
        out.push_back(later(t.spot, coming + t.spot.part + 3 * count[static_cast<std::size_t>(t.spot.part)]++));
    }
    std::ranges::stable_sort(out, {}, &RoundContact::obstacle);
}

} // namespace raycontact
