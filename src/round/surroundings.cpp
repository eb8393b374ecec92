// SPDX-License-Identifier: Apache-2.0
#include "round/surroundings.h"

#include "mesh/vector.h"
#include "round/axis.h"
#include "round/lines.h"
#include "shape/angle.h"

#include <raycontact/query.h>

#include <algorithm>
#include <limits>
#include <numbers>

namespace raycontact {

namespace {

/// Of squared distances, in squares of the greatest: what rounding leaves open.
constexpr double rounding = 1e-12;
/// Of a surface's size: points that count as one, since they are computed in several ways.
constexpr double one_point = 1e-9;
/// Of the greatest distance: places that count as one.
constexpr double one_place = 1e-3;
/// Cosine by which a direction counts as the normal of a face.
constexpr double of_a_face = 1 - 1e-9;

Vec3 seen_from_body(const Pose& pose, const Vec3& world) {
    return rotated_back(pose.rotation, world - pose.translation);
}

bool in_box(const Facet& f, const Vec3& p, double around) {
    return p.x >= f.low.x - around && p.x <= f.high.x + around && p.y >= f.low.y - around && p.y <= f.high.y + around
           && p.z >= f.low.z - around && p.z <= f.high.z + around;
}

/// Of a facet as seen from a point of it: 2 pi within, pi on an edge.
double angle_at(const Facet& f, unsigned on) {
    if (on == 7) return 2 * std::numbers::pi;
    if ((on & (on - 1)) != 0) return std::numbers::pi;
    const std::size_t k = on >> 1;
    return corner_angles(f.corner)[k];
}

/// Of two at one place the face speaks: an edge may yet be a step.
void add(std::vector<Spot>& spots, const Spot& spot, double limit) {
    const auto known = std::ranges::find_if(spots, [&](const Spot& s) {
        return length2(s.point - spot.point) < one_place * one_place * limit * limit && s.away * spot.away > 0;
    });
    if (known == spots.end())
        spots.push_back(spot);
    else if (spot.flat && !known->flat)
        *known = spot;
}

} // namespace

Surroundings::Surroundings(const Round& round, const Pose& pose, const std::optional<Pose>& next,
                           std::span<const Obstacle> obstacles, double reach)
    : round_(round) {
    for (const Obstacle& o : obstacles) margin_ = std::max(margin_, o.margin);
    for (const Obstacle& o : obstacles) {
        Site& site = sites_.emplace_back();
        site.obstacle = &o;
        site.pose = o.pose;
        constexpr double far = std::numeric_limits<double>::max();
        Vec3 low{far, far, far}, high{-far, -far, -far};
        double longest = 0;
        for (int e = 0; e < 2; ++e) {
            const Vec3 now = site.start[e] = site.from[e] =
                seen_from_body(site.pose, transform_point(pose, e == 0 ? round.from : round.to));
            if (next) site.by[e] = seen_from_body(o.next, transform_point(*next, e == 0 ? round.from : round.to)) - now;
            longest = std::max(longest, length(site.by[e]));
            for (const Vec3& p : {now, now + site.by[e]}) {
                low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
                high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
            }
        }
        // What bends a way turns it out of its box by no more than half its length.
        const double around = round.radius + reach + margin_ + longest / 2;
        const Vec3 more{around, around, around};
        o.surface.near(low - more, high + more, site.facets);
    }
}

Vec3 Surroundings::axis(std::size_t site, double at, double part) const {
    const Site& s = sites_[site];
    return (1 - at) * (s.from[0] + part * s.by[0]) + at * (s.from[1] + part * s.by[1]);
}

Vec3 Surroundings::way(std::size_t obstacle, double at) const {
    const Site& s = sites_[obstacle];
    return (1 - at) * s.by[0] + at * s.by[1];
}

// By what is between it and the axis there: both obstacles see the same.
Vec3 Surroundings::seen_from(std::size_t other, std::size_t site, const Vec3& point, double at, double part) const {
    if (other == site) return point;
    const Vec3 offset = rotated(sites_[site].pose.rotation, point - axis(site, at, part));
    return axis(other, at, part) + rotated_back(sites_[other].pose.rotation, offset);
}

double Surroundings::beside(std::size_t site) const {
    return sites_[site].obstacle->margin + one_point * sites_[site].obstacle->surface.size();
}

void Surroundings::deflect(std::span<const Spot> spots) {
    constexpr int rounds = 8; // each sends it into the others, ever less
    for (int i = 0; i < rounds; ++i)
        for (const Spot& spot : spots) deflect(spot);
}

// As a free uniform rod of the same length is pushed there: the other end swings.
void Surroundings::deflect(const Spot& spot) {
    const double into = dot(way(spot.obstacle, spot.at), spot.normal);
    if (into >= 0) return;
    const Site& site = sites_[spot.obstacle];
    const Vec3 along = site.from[1] - site.from[0];
    const double square = length2(along), gyration2 = square / 12 + 0.4 * round_.radius * round_.radius;
    const double along_normal = square > 0 ? dot(along, spot.normal) / square : 0;
    const Vec3 across = spot.normal - along_normal * along;
    // How far a place on the axis goes for each unit that the middle goes.
    const auto moved = [&](double at) {
        return spot.normal + ((spot.at - 0.5) * (at - 0.5) * square / gyration2) * across;
    };
    const double push = -into / dot(moved(spot.at), spot.normal);
    for (int e = 0; e < 2; ++e) {
        const Vec3 back = rotated(site.pose.rotation, push * moved(e));
        for (Site& s : sites_) s.by[e] = s.by[e] + rotated_back(s.pose.rotation, back);
    }
}

void Surroundings::advance(double part) {
    for (Site& s : sites_)
        for (int e = 0; e < 2; ++e) {
            s.from[e] = s.from[e] + part * s.by[e];
            s.by[e] = (1 - part) * s.by[e];
        }
}

bool Surroundings::is_least(std::size_t obstacle, const Vec3& point, double at, double part) const {
    const double away2 = length2(axis(obstacle, at, part) - point), near = beside(obstacle);
    for (std::size_t k = 0; k < sites_.size(); ++k) {
        const Vec3 p = seen_from(k, obstacle, point, at, part), centre = axis(k, at, part);
        for (const Facet& f : sites_[k].facets)
            if (in_box(f, p, near) && nearest(f, centre).away2 < away2 * (1 - rounding)
                && nearest(f, p).away2 <= near * near)
                return false;
    }
    return true;
}

// A step that is lower than the margin: the surface goes on beside it towards the round, in the plane of a face that it
// is over.
bool Surroundings::is_step(const Spot& spot, std::span<const Spot> spots, double part) const {
    const double near = beside(spot.obstacle);
    const bool in_plane = std::ranges::any_of(spots, [&](const Spot& s) {
        if (!s.flat || s.away <= 0) return false;
        const Vec3 p = seen_from(s.obstacle, spot.obstacle, spot.point, spot.at, part);
        return std::fabs(dot(p - s.point, s.normal)) <= near;
    });
    if (!in_plane) return false;
    for (std::size_t k = 0; k < sites_.size(); ++k) {
        const Vec3 p = seen_from(k, spot.obstacle, spot.point, spot.at, part), centre = axis(k, spot.at, part);
        for (const Facet& f : sites_[k].facets) {
            if (!in_box(f, p, near)) continue;
            const Nearest below = nearest(f, p);
            if (below.away2 > near * near) continue;
            const double from = length2(below.point - centre);
            if (nearest(f, centre).away2 < from * (1 - rounding)) return true;
        }
    }
    return false;
}

// Nowhere nearer, as beside a capsule that lies flat: the ends of the plateau tell it.
bool Surroundings::is_plateau(const Spot& spot, double part) const {
    const double aside = 0.01 * spot.away, near = aside + beside(spot.obstacle);
    std::array<bool, 2> goes_on{};
    for (std::size_t k = 0; k < sites_.size(); ++k) {
        const Vec3 p = seen_from(k, spot.obstacle, spot.point, spot.at, part), centre = axis(k, spot.at, part);
        const Vec3 along = axis(k, 1, part) - axis(k, 0, part);
        const Vec3 step = (aside / length(along)) * along;
        for (const Facet& f : sites_[k].facets) {
            if (!in_box(f, p, near)) continue;
            for (const std::size_t side : {0, 1}) {
                const Vec3 beside_it = side == 0 ? centre - step : centre + step;
                goes_on[side] = goes_on[side] || nearest(f, beside_it).away2 <= spot.away * spot.away * (1 + 1e-9);
            }
        }
    }
    return goes_on[0] && goes_on[1];
}

// Which side the axis is on, by the angle-weighted normal there (Baerentzen and Aanaes 2005).
void Surroundings::finish(const Site& site, const Facet& facet, unsigned on, const Vec3& centre, Spot& spot) const {
    const Vec3 between = centre - spot.point;
    const double away = length(between);
    Vec3 out = facet.normal;
    spot.flat = true;
    if (on != 7) {
        const double here = one_point * site.obstacle->surface.size();
        out = {};
        double most = 0;
        for (const Facet& f : site.facets) {
            if (!in_box(f, spot.point, here)) continue;
            const Nearest n = nearest(f, spot.point);
            if (n.away2 > here * here) continue;
            out = out + angle_at(f, n.on) * f.normal;
            most = std::max(most, std::fabs(dot(f.normal, between)));
        }
        spot.flat = most >= of_a_face * away;
    }
    const bool inside = !site.obstacle->two_sided && dot(out, between) < 0;
    spot.away = inside ? -away : away;
    // On the surface itself the line from it to the axis has no direction.
    spot.normal =
        away > one_point * (site.obstacle->surface.size() + round_.radius) ? (1 / spot.away) * between : facet.normal;
    if (const Shape* shape = site.obstacle->surface.shape()) spot.triangle = shape->triangle_index()[facet.triangle];
    spot.name = facet.name;
}

void Surroundings::of_end(int end, double part, double limit, std::vector<std::vector<Spot>>& out) const {
    static thread_local std::vector<Entry> entries;
    entries.clear();
    for (std::size_t k = 0; k < sites_.size(); ++k) {
        const Vec3 centre = axis(k, end, part);
        for (const Facet& f : sites_[k].facets) {
            if (!in_box(f, centre, limit)) continue;
            const Nearest n = nearest(f, centre);
            if (n.away2 < limit * limit) entries.push_back({n.away2, k, &f, n});
        }
    }
    std::ranges::stable_sort(entries, {}, &Entry::away2);
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const Entry& e = entries[i];
        const double near = beside(e.site);
        bool least = true;
        // No facet that is there is nearer. The one that is mostly is but little nearer.
        for (std::size_t j = i; least && e.nearest.on != 7 && j-- > 0;) {
            const Entry& nearer = entries[j];
            if (nearer.away2 >= e.away2 - rounding * limit * limit) continue;
            const Vec3 p = seen_from(nearer.site, e.site, e.nearest.point, end, part);
            least = !in_box(*nearer.facet, p, near) || nearest(*nearer.facet, p).away2 > near * near;
        }
        if (!least) continue;
        Spot spot{.obstacle = e.site, .part = end, .at = double(end), .point = e.nearest.point};
        finish(sites_[e.site], *e.facet, e.nearest.on, axis(e.site, end, part), spot);
        add(out[e.site], spot, limit);
    }
    for (std::size_t k = 0; k < sites_.size(); ++k) {
        std::vector<Spot>& spots = out[k];
        const Facets& surface = sites_[k].obstacle->surface;
        if (spots.empty()) {
            // So deep inside that no surface is in reach.
            const Vec3 centre = axis(k, end, part);
            if (!surface.shape() || sites_[k].obstacle->two_sided || !contains(*surface.shape(), centre)) continue;
            const auto way_out = closest_point(*surface.shape(), {}, centre);
            if (!way_out || !(way_out->distance > 0)) continue;
            spots.push_back({.obstacle = k,
                             .part = end,
                             .at = double(end),
                             .point = way_out->point,
                             .normal = (1 / way_out->distance) * (way_out->point - centre),
                             .away = -way_out->distance,
                             .flat = true,
                             .triangle = way_out->triangle});
        } else if (spots[0].away < 0) { // the nearest comes first
            spots.resize(1);
        } else { // faces seen from behind belong to the far side of something thin
            std::erase_if(spots, [](const Spot& s) { return s.away < 0; });
        }
    }
}

void Surroundings::of_side(double part, double limit, std::vector<std::vector<Spot>>& out) const {
    static thread_local std::vector<Entry> entries; // by the distance from the axis
    entries.clear();
    struct Candidate {
        Entry entry; // nearest: the place on the facet
        double at;
    };
    static thread_local std::vector<Candidate> candidates;
    candidates.clear();
    for (std::size_t k = 0; k < sites_.size(); ++k) {
        const Vec3 a = axis(k, 0, part), along = axis(k, 1, part) - a;
        const double length2_along = length2(along);
        for (const Facet& f : sites_[k].facets) {
            if (least_away(f, a, a + along) >= limit) continue;
            double least = std::min(nearest(f, a).away2, nearest(f, a + along).away2);
            const double slope = dot(f.normal, along),
                         through = slope != 0 ? dot(f.normal, f.corner[0] - a) / slope : 2;
            if (through > 0 && through < 1 && nearest(f, a + through * along).on == 7) least = 0;
            const auto consider = [&](const Vec3& p, unsigned on, double at) {
                if (!(at > 0 && at < 1)) return; // the ends see it
                const Vec3 centre = a + at * along;
                const double away2 = length2(p - centre);
                least = std::min(least, away2);
                if (away2 >= limit * limit || nearest(f, centre).away2 < away2 - rounding * limit * limit) return;
                candidates.push_back({{away2, k, &f, {p, away2, on}}, at});
            };
            for (std::size_t i = 0; i < 3; ++i) {
                const Vec3 &p = f.corner[i], edge = f.corner[(i + 1) % 3] - p;
                const unsigned corner_bit = 1u << i, edge_bits = corner_bit | 1u << (i + 1) % 3;
                consider(p, corner_bit, dot(p - a, along) / length2_along);
                const double square = length2(cross(along, edge));
                if (square <= 1e-12 * length2_along * length2(edge)) continue; // parallel: corners and ends see it
                const auto [at, on_edge] = closest_on_lines(a, along, p, edge, square);
                if (on_edge > 0 && on_edge < 1) consider(p + on_edge * edge, edge_bits, at);
            }
            if (least < limit * limit) entries.push_back({least, k, &f, {}});
        }
    }
    std::ranges::stable_sort(candidates, {}, [](const Candidate& c) { return c.entry.away2; });
    std::ranges::stable_sort(entries, {}, &Entry::away2);
    for (const auto& [e, at] : candidates) {
        const double near = beside(e.site), nearer_than = e.away2 - rounding * limit * limit;
        bool least = true;
        // The facet that is nearer there is mostly but little nearer.
        for (auto other = std::ranges::lower_bound(entries, nearer_than, {}, &Entry::away2);
             least && other-- != entries.begin();) {
            const Vec3 p = seen_from(other->site, e.site, e.nearest.point, at, part);
            least = !in_box(*other->facet, p, near) || nearest(*other->facet, p).away2 > near * near
                    || nearest(*other->facet, axis(other->site, at, part)).away2 >= nearer_than;
        }
        if (!least) continue;
        Spot spot{.obstacle = e.site, .part = 2, .at = at, .point = e.nearest.point, .away = std::sqrt(e.away2)};
        if (is_plateau(spot, part)) continue;
        finish(sites_[e.site], *e.facet, e.nearest.on, axis(e.site, at, part), spot);
        if (spot.away > 0) add(out[e.site], spot, limit);
    }
}

// What neither ends nor sides see: an axis inside the mesh between them.
void Surroundings::of_axis(std::size_t k, double part, std::vector<Spot>& first, std::vector<Spot>& second,
                           std::vector<Spot>& side) const {
    static thread_local std::vector<AxisExit> ways;
    const Obstacle& o = *sites_[k].obstacle;
    const Vec3 a = axis(k, 0, part), b = axis(k, 1, part);
    if (o.two_sided) {
        ways_through(o.surface, a, b, ways);
        // The end that is on the other side would be pushed there.
        const auto against = [&](const Spot& s) {
            return std::ranges::any_of(ways, [&](const AxisExit& way) { return dot(way.normal, s.normal) < 0; });
        };
        for (std::vector<Spot>* spots : {&first, &second, &side}) std::erase_if(*spots, against);
    } else {
        const auto is_inside = [&](const std::vector<Spot>& spots) {
            return o.surface.has_inside() || std::ranges::any_of(spots, [](const Spot& s) { return s.away < 0; });
        };
        ways_out(o.surface, a, b, {is_inside(first), is_inside(second)}, ways);
    }
    for (const AxisExit& way : ways) {
        Spot spot{.obstacle = k,
                  .part = 2,
                  .at = 0.5,
                  .point = way.point,
                  .normal = way.normal,
                  .away = -way.depth,
                  .flat = true,
                  .name = way.facet.name};
        if (const Shape* shape = o.surface.shape()) spot.triangle = shape->triangle_index()[way.facet.triangle];
        side.push_back(spot);
    }
}

// Decided with all that are little farther: an edge may be a step beside a face.
void Surroundings::spots(double part, double limit, std::vector<Spot>& out) const {
    out.clear();
    const double farther = limit + margin_;
    std::array<std::vector<std::vector<Spot>>, 3> found; // by part and obstacle
    for (auto& of_part : found) of_part.resize(sites_.size());
    of_end(0, part, farther, found[0]);
    if (balls_of(round_) > 1) {
        of_end(1, part, farther, found[1]);
        of_side(part, farther, found[2]);
        for (std::size_t k = 0; k < sites_.size(); ++k) of_axis(k, part, found[0][k], found[1][k], found[2][k]);
    }
    std::vector<Spot> all;
    for (std::size_t k = 0; k < sites_.size(); ++k)
        for (auto& of_part : found) {
            std::ranges::stable_sort(of_part[k], {}, &Spot::triangle); // numbers stay while distances change
            all.insert(all.end(), of_part[k].begin(), of_part[k].end());
        }
    for (const Spot& s : all)
        if (s.away < limit && (s.flat || s.away <= 0 || !is_step(s, all, part))) out.push_back(s);
}

} // namespace raycontact
