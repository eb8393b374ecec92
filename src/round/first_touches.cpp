// SPDX-License-Identifier: Apache-2.0
#include "round/first_touches.h"

#include "mesh/vector.h"
#include "round/lines.h"
#include "round/polynomial.h"

#include <algorithm>

namespace raycontact {

namespace {

using raycontact::leads_into;

constexpr int most_turns = 8;
/// Sine of an angle at which the way leads along a surface.
constexpr double level = 1e-3;
/// Of the radius: within which what comes together is touched at once.
constexpr double together = 1e-6;

/// An end or a place of the axis is for the first time so near to a feature.
struct Event {
    double part;
    std::size_t obstacle;
    double at; ///< on the axis
    Vec3 point;
    bool of_face;
};

/// How far the rest of the way leads beyond a surface; and how long that is.
FirstTouch touch_at(const Surroundings& s, const Spot& spot) {
    const Vec3 way = s.way(spot.obstacle, spot.at);
    return {spot, -dot(way, spot.normal), length(way)};
}

bool leads_into(const Surroundings& s, std::size_t obstacle, double at, const Vec3& normal) {
    return leads_into(s.way(obstacle, at), normal);
}

/// Finds the events of one obstacle.
class Features {
public:
    Features(const Surroundings& surroundings, std::size_t obstacle, double radius, std::vector<Event>& events)
        : s_(surroundings), obstacle_(obstacle), site_(surroundings.sites()[obstacle]),
          radius_(radius), axis_{site_.from[1] - site_.from[0], site_.by[1] - site_.by[0]}, events_(events) {}

    void find() {
        const int balls = balls_of(s_.round());
        const double longest = std::max(length(site_.by[0]), length(site_.by[1]));
        for (const Facet& f : site_.facets) {
            if (least_away(f, site_.from[0], site_.from[1]) > radius_ + longest) continue;
            if (site_.obstacle->surface.has_inside() && !looks_back(f)) continue;
            for (int e = 0; e < balls; ++e) {
                face(f, e);
                for (std::size_t k = 0; k < 3; ++k) {
                    corner_of_end(f.corner[k], e);
                    edge_of_end(f.corner[k], f.corner[(k + 1) % 3] - f.corner[k], e);
                }
            }
            for (std::size_t k = 0; balls > 1 && k < 3; ++k) {
                corner_of_axis(f.corner[k]);
                edge_of_axis(f.corner[k], f.corner[(k + 1) % 3] - f.corner[k]);
            }
        }
    }

private:
    /// Against the way: else all that a closed mesh has there to be met is told by other facets.
    bool looks_back(const Facet& f) const {
        return std::ranges::any_of(site_.by, [&](const Vec3& by) { return dot(f.normal, by) < -1e-5 * length(by); });
    }
    void add(double part, double at, const Vec3& point, bool of_face) {
        const Vec3 centre = (1 - at) * (site_.from[0] + part * site_.by[0]) + at * (site_.from[1] + part * site_.by[1]);
        if (leads_into(s_, obstacle_, at, (1 / radius_) * (centre - point)))
            events_.push_back({part, obstacle_, at, point, of_face});
    }
    void face(const Facet& f, int e) {
        double height = dot(f.normal, site_.from[e] - f.corner[0]), by = dot(f.normal, site_.by[e]);
        const double side = site_.obstacle->two_sided && height < 0 ? -1 : 1;
        height *= side, by *= side;
        if (!(height > radius_ && height + by <= radius_)) return;
        const double part = (radius_ - height) / by;
        const Nearest n = nearest(f, site_.from[e] + part * site_.by[e]);
        if (n.on == 7) add(part, e, n.point, true);
    }
    void corner_of_end(const Vec3& p, int e) {
        const Vec3 from = site_.from[e] - p, &by = site_.by[e];
        const Polynomial<2> gap{{length2(from) - radius_ * radius_, 2 * dot(from, by), length2(by)}};
        each_fall(gap, [&](double part) { add(part, e, p, false); });
    }
    void edge_of_end(const Vec3& p, const Vec3& edge, int e) {
        const Vec3 from = site_.from[e] - p, &by = site_.by[e];
        const Vec3 n_from = cross(from, edge), n_by = cross(by, edge);
        const double square = length2(edge);
        const Polynomial<2> gap{{length2(n_from) - radius_ * radius_ * square, 2 * dot(n_from, n_by), length2(n_by)}};
        each_fall(gap, [&](double part) {
            const double on_edge = dot(from + part * by, edge) / square;
            if (on_edge > 0 && on_edge < 1) add(part, e, p + on_edge * edge, false);
        });
    }
    void corner_of_axis(const Vec3& p) {
        // |between x axis|^2 - (radius |axis|)^2, each linear in the part.
        const std::array<Vec3, 2> between{site_.from[0] - p, site_.by[0]};
        Polynomial<4> gap = squared(cross_product(between, axis_));
        subtract_radius(axis_, gap);
        each_fall(gap, [&](double part) {
            const Vec3 along = axis_[0] + part * axis_[1], off = between[0] + part * between[1];
            const double at = -dot(off, along) / length2(along);
            if (at > 0 && at < 1) add(part, at, p, false);
        });
    }
    void edge_of_axis(const Vec3& p, const Vec3& edge) {
        // (between . normal)^2 - (radius |normal|)^2, with normal = axis x edge.
        const std::array<Vec3, 2> between{site_.from[0] - p, site_.by[0]};
        const std::array<Vec3, 2> normal{cross(axis_[0], edge), cross(axis_[1], edge)};
        const std::array<double, 3> volume{dot(between[0], normal[0]),
                                           dot(between[0], normal[1]) + dot(between[1], normal[0]),
                                           dot(between[1], normal[1])};
        Polynomial<4> gap;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 3; ++k) gap.c[i + k] += volume[i] * volume[k];
        subtract_radius(normal, gap);
        each_fall(gap, [&](double part) {
            const Vec3 along = axis_[0] + part * axis_[1], off = between[0] + part * between[1];
            const double square = length2(normal[0] + part * normal[1]);
            if (square <= 1e-12 * length2(along) * length2(edge)) return;
            const auto [at, on_edge] = closest_on_lines(p + off, along, p, edge, square);
            if (at > 0 && at < 1 && on_edge > 0 && on_edge < 1) add(part, at, p + on_edge * edge, false);
        });
    }

    using Linear = std::array<Vec3, 2>;
    static std::array<Vec3, 3> cross_product(const Linear& a, const Linear& b) {
        return {cross(a[0], b[0]), cross(a[0], b[1]) + cross(a[1], b[0]), cross(a[1], b[1])};
    }
    static Polynomial<4> squared(const std::array<Vec3, 3>& v) {
        return {{dot(v[0], v[0]), 2 * dot(v[0], v[1]), 2 * dot(v[0], v[2]) + dot(v[1], v[1]), 2 * dot(v[1], v[2]),
                 dot(v[2], v[2])}};
    }
    void subtract_radius(const Linear& v, Polynomial<4>& gap) const {
        const double square = radius_ * radius_;
        gap.c[0] -= square * dot(v[0], v[0]);
        gap.c[1] -= square * 2 * dot(v[0], v[1]);
        gap.c[2] -= square * dot(v[1], v[1]);
    }
    template <std::size_t N, class Visit>
    static void each_fall(const Polynomial<N>& gap, Visit&& visit) {
        const Places<N> falls = sign_changes(gap, true);
        for (std::size_t i = 0; i < falls.count; ++i) visit(falls.at[i]);
    }

    const Surroundings& s_;
    std::size_t obstacle_;
    const Site& site_;
    double radius_;
    Linear axis_; ///< its vector, linear in the part
    std::vector<Event>& events_;
};

/// What is touched first on this piece of the way, and when.
std::vector<Spot> first_touched(const Surroundings& s, double radius, double& part) {
    static thread_local std::vector<Event> events;
    events.clear();
    for (std::size_t k = 0; k < s.sites().size(); ++k) Features(s, k, radius, events).find();
    std::ranges::stable_sort(events, {}, &Event::part);
    std::vector<Spot> spots;
    for (const Event& event : events) {
        if (!event.of_face && !s.is_least(event.obstacle, event.point, event.at, event.part)) continue;
        s.spots(event.part, radius * (1 + together), spots);
        std::erase_if(spots, [&](const Spot& spot) {
            return spot.away <= 0 || !leads_into(s, spot.obstacle, spot.at, spot.normal);
        });
        part = event.part;
        if (!spots.empty()) return spots;
    }
    return {};
}

} // namespace

bool leads_into(const Vec3& way, const Vec3& normal) {
    return dot(way, normal) < -level * length(way);
}

bool find_first_touches(Surroundings& s, std::vector<FirstTouch>& touched) {
    touched.clear();
    // What touches is as if it were on the surface: else it would be past what joins that at a small angle.
    double radius = s.round().radius;
    std::vector<Spot> spots;
    s.spots(0, radius, spots);
    for (const Spot& spot : spots)
        if (spot.away > 0) radius = std::min(radius, std::max(spot.away, s.round().radius / 2));
    s.deflect(spots);
    for (int turn = 0; turn < most_turns; ++turn) {
        double part = 1;
        spots = first_touched(s, radius, part);
        if (spots.empty()) return true;
        s.advance(part);
        for (const Spot& spot : spots) touched.push_back(touch_at(s, spot));
        s.deflect(spots);
    }
    return false;
}

} // namespace raycontact
