// SPDX-License-Identifier: Apache-2.0
#include "round/two_rounds.h"

#include "mesh/vector.h"
#include "round/lines.h"
#include "round/rod.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace raycontact {

namespace {

/// Sine of the angle up to which capsules lie beside each other: a witness point is off the surface by its square.
constexpr double beside = 0.05;
/// Of both radii: lengths and distances that count as one; of contacts that touch later and others.
constexpr double one_place = 1e-3, beside_of_end = 0.25;
/// Of both radii: what touches to that.
constexpr double in_touch = 1e-6;
/// Cosines from which on what touches later is what is near, and is on the same side.
constexpr double alike = 0.9, one_side = 0.5;
/// Of both radii: axes that are nearer than this have no direction between them.
constexpr double no_way = 1e-12;

/// An axis, of a ball as of a capsule without length.
struct Axis {
    std::array<Vec3, 2> end;
    Vec3 at(double part) const { return (1 - part) * end[0] + part * end[1]; }
    Vec3 along() const { return end[1] - end[0]; }
    double foot(const Vec3& p) const {
        const double square = length2(along());
        return square > 0 ? dot(p - end[0], along()) / square : 0;
    }
};

/// A place on either axis, 0 at the first end, 1 at the second.
struct Places {
    double on_a, on_b;
};

class TwoAxes {
public:
    TwoAxes(const Axis& a, const Axis& b) : a_(a), b_(b) {}

    Vec3 between(const Places& p) const { return b_.at(p.on_b) - a_.at(p.on_a); }
    double away(const Places& p) const { return length(between(p)); }

    Places nearest() const {
        Places best{0, 0};
        double least = away(best);
        const auto consider = [&](const Places& p) {
            if (const double here = away(p); here < least) least = here, best = p;
        };
        for (const int e : {0, 1}) {
            consider({double(e), std::clamp(b_.foot(a_.end[std::size_t(e)]), 0.0, 1.0)});
            consider({std::clamp(a_.foot(b_.end[std::size_t(e)]), 0.0, 1.0), double(e)});
        }
        const Vec3 along_a = a_.along(), along_b = b_.along();
        const double square = length2(cross(along_a, along_b));
        if (square > 1e-12 * length2(along_a) * length2(along_b)) {
            const auto [on_a, on_b] = closest_on_lines(a_.end[0], along_a, b_.end[0], along_b, square);
            if (on_a > 0 && on_a < 1 && on_b > 0 && on_b < 1) consider({on_a, on_b});
        }
        return best;
    }

    /// Ends of the stretch along which the axes lie beside each other, in a's order; false if there is none, or they
    /// are not parallel, nearly.
    bool stretch(std::array<Places, 2>& ends) const {
        const double lengths = length(a_.along()) * length(b_.along());
        if (!(lengths > 0 && length(cross(a_.along(), b_.along())) <= beside * lengths)) return false;
        std::array<Places, 4> found;
        std::size_t count = 0;
        for (const int e : {0, 1}) {
            const double on_b = b_.foot(a_.end[std::size_t(e)]), on_a = a_.foot(b_.end[std::size_t(e)]);
            if (on_b >= 0 && on_b <= 1) found[count++] = {double(e), on_b};
            if (on_a >= 0 && on_a <= 1) found[count++] = {on_a, double(e)};
        }
        if (count < 2) return false;
        const auto [first, last] =
            std::minmax_element(found.begin(), found.begin() + std::ptrdiff_t(count),
                                [](const Places& p, const Places& q) { return p.on_a < q.on_a; });
        ends = {*first, *last};
        return true;
    }

    /// Where they cross or lie on each other: across both, or across one.
    Vec3 across() const {
        const Vec3 along_a = unit(a_.along()), along_b = unit(b_.along()), both = cross(along_a, along_b);
        if (length(both) > 1e-6) return unit(both);
        const Vec3 along = length2(along_a) > 0 ? along_a : along_b;
        const bool steep = std::fabs(along.z) > 0.5;
        const Vec3 side = cross(along, steep ? Vec3{1, 0, 0} : Vec3{0, 0, 1});
        return length2(side) > 0 ? unit(side) : Vec3{0, 0, 1};
    }

private:
    Axis a_, b_;
};

/// Two axes whose ends go straight.
struct MovingAxes {
    Axis a, b;
    std::array<Vec3, 2> way_a, way_b;

    TwoAxes at(double part) const {
        const auto moved = [&](const Axis& axis, const std::array<Vec3, 2>& way) {
            return Axis{{axis.end[0] + part * way[0], axis.end[1] + part * way[1]}};
        };
        return {moved(a, way_a), moved(b, way_b)};
    }
    /// By how much the axes come together along a direction from a to b, at most.
    double closing(const Vec3& normal) const {
        return std::max(dot(way_a[0], normal), dot(way_a[1], normal))
               - std::min(dot(way_b[0], normal), dot(way_b[1], normal));
    }
    void advance(double part) {
        for (const std::size_t e : {0, 1}) {
            a.end[e] += part * way_a[e], way_a[e] *= 1 - part;
            b.end[e] += part * way_b[e], way_b[e] *= 1 - part;
        }
    }
    /// Takes from the rest of the way of the one that goes farther what leads into the other. normal: from a to b.
    void deflect(const Places& p, const Vec3& normal, const std::array<double, 2>& radii) {
        const double into = -dot(way(p), normal);
        if (!(into > 0)) return;
        const auto far = [](const std::array<Vec3, 2>& ways) { return length2(ways[0]) + length2(ways[1]); };
        const bool of_a = far(way_a) >= far(way_b);
        const double at = of_a ? p.on_a : p.on_b, radius = radii[of_a ? 0 : 1];
        const Vec3 along = (of_a ? a : b).along(), out = of_a ? -normal : normal;
        const RodPush push(along, radius, at, out);
        const double metres = push.needed(into);
        for (const std::size_t e : {0, 1}) (of_a ? way_a : way_b)[e] += metres * push.moved(double(e));
    }
    /// Of two places.
    Vec3 way(const Places& p) const {
        const auto of = [](const std::array<Vec3, 2>& way, double at) { return (1 - at) * way[0] + at * way[1]; };
        return of(way_b, p.on_b) - of(way_a, p.on_a);
    }
    /// The first part of the way after which they are `distance` apart: what is between them along a direction keeps
    /// them apart until it is gone (conservative advancement: Mirtich 1996).
    std::optional<double> touch(double distance) const {
        constexpr int most_tries = 100;
        double part = 0;
        for (int i = 0; i < most_tries; ++i) {
            const TwoAxes axes = at(part);
            const Vec3 between = axes.between(axes.nearest());
            const double away = length(between), gap = away - distance;
            if (gap <= in_touch * distance) return part;
            const double speed = closing((1 / away) * between);
            if (!(part + gap / (speed > 0 ? speed : 0) <= 1)) return std::nullopt;
            part += gap / speed;
        }
        return part;
    }
};

} // namespace

void two_round_contacts(const MovingRound& a, const MovingRound& b, double reach, std::vector<RoundContact>& out) {
    out.clear();
    const Vec3 origin = a.pose.translation; // far from the world's, positions lose digits that differences keep
    const auto seen = [&](const Pose& pose, const Round& round) {
        const Pose near{pose.rotation, pose.translation - origin};
        return Axis{{transform_point(near, round.from), transform_point(near, round.to)}};
    };
    MovingAxes moving{seen(a.pose, a.round), seen(b.pose, b.round), {}, {}};
    const bool ahead = a.next && b.next;
    if (ahead) {
        const Axis then_a = seen(*a.next, a.round), then_b = seen(*b.next, b.round);
        for (const std::size_t e : {0, 1}) {
            moving.way_a[e] = then_a.end[e] - moving.a.end[e];
            moving.way_b[e] = then_b.end[e] - moving.b.end[e];
        }
    }
    const TwoAxes now = moving.at(0);
    const double both = a.round.radius + b.round.radius, one = one_place * both;
    const auto add = [&](int place, const Places& p, const Vec3& normal, double distance, bool is_later) {
        out.push_back({.place = place,
                       .is_later = is_later,
                       .point = origin + moving.b.at(p.on_b) - b.round.radius * normal,
                       .normal = -normal,
                       .distance = distance});
    };

    const Places nearest = now.nearest();
    const double away = now.away(nearest);
    const Vec3 normal = away > no_way * both ? (1 / away) * now.between(nearest) : now.across();
    // What passes the plane between them is asked when it touches.
    const auto stays = [&](const Places& p, const Vec3& along, double distance) {
        return distance <= 0 || !ahead || dot(moving.way(p), along) >= -distance;
    };
    if (const double distance = away - both; distance <= reach && stays(nearest, normal, distance)) {
        std::array<Places, 2> ends;
        bool main_counts = true;
        if (now.stretch(ends) && away > one) {
            double least = both + reach;
            int told = 0;
            for (const int e : {0, 1}) {
                const Places& p = ends[std::size_t(e)];
                const double here = now.away(p);
                if (here - both > reach || dot(now.between(p), normal) <= 0) continue;
                if (e == 1 && told == 1 && length(moving.a.at(p.on_a) - moving.a.at(ends[0].on_a)) <= one) continue;
                add(e, p, (1 / here) * now.between(p), here - both, false);
                least = std::min(least, here);
                ++told;
            }
            main_counts = told == 0 || away < least - one;
        }
        if (main_counts) add(2, nearest, normal, distance, false);
    }
    if (!ahead) return;
    // What touches later: the axes, and each end by itself, since what is near at one end says nothing of the other;
    // going on along what it touched first.
    MovingAxes rest = moving;
    const double touching = both * (1 + 10 * in_touch);
    std::array<bool, 5> done{};
    for (;;) {
        int place = 0;
        double first = 2;
        Places there{};
        const auto consider = [&](int of_place, const MovingAxes& of, const auto& places_of) {
            if (done[std::size_t(of_place)] || of.at(0).away(of.at(0).nearest()) <= touching) return;
            const std::optional<double> touch = of.touch(both);
            if (!touch || *touch >= first) return;
            first = *touch;
            place = of_place;
            there = places_of(of.at(first).nearest());
        };
        consider(2, rest, [](const Places& p) { return p; });
        for (const std::size_t e : {0, 1}) {
            const double end = double(e);
            const auto of_end = [e](const std::array<Vec3, 2>& v) { return std::array<Vec3, 2>{v[e], v[e]}; };
            const auto on_a = [&](const Places& p) { return Places{end, p.on_b}; };
            const auto on_b = [&](const Places& p) { return Places{p.on_a, end}; };
            if (length2(rest.a.along()) > 0)
                consider(int(e), {{of_end(rest.a.end)}, rest.b, of_end(rest.way_a), rest.way_b}, on_a);
            if (length2(rest.b.along()) > 0)
                consider(3 + int(e), {rest.a, {of_end(rest.b.end)}, rest.way_a, of_end(rest.way_b)}, on_b);
        }
        if (first > 1) return;
        done[std::size_t(place)] = true;
        rest.advance(first);
        const Vec3 between = rest.at(0).between(there);
        if (!(length2(between) > 0)) return;
        const Vec3 at_touch = unit(between), own_place = moving.a.at(there.on_a);
        rest.deflect(there, at_touch, {a.round.radius, b.round.radius});
        const bool is_told = std::ranges::any_of(out, [&](const RoundContact& c) {
            const Vec3 own = c.point - origin + (a.round.radius + c.distance) * c.normal;
            return dot(at_touch, -c.normal) >= alike && length(own - own_place) <= beside_of_end * both;
        });
        // Two convex bodies are on one side of each other for a step.
        const bool is_elsewhere = !out.empty() && dot(at_touch, -out[0].normal) < one_side;
        if (!is_told && !is_elsewhere)
            add(coming + place, there, at_touch, std::max(dot(now.between(there), at_touch) - both, 0.0), true);
    }
}

} // namespace raycontact
