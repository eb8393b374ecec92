// SPDX-License-Identifier: Apache-2.0
#include "round/surroundings.h"

#include "mesh/vector.h"
#include "round/axis.h"
#include "round/lines.h"
#include "round/rod.h"
#include "shape/angle.h"

#include <raycontact/query.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>

namespace raycontact {

namespace {

/// Of squared distances, in squares of the greatest: what rounding leaves open.
constexpr double rounding = 1e-12;
/// Of a surface's size: points that count as one, since they are computed in several ways.
constexpr double one_point = 1e-9;
/// Of the greatest distance: places that count as one.
constexpr double one_place = 1e-3;
/// Sine of the angle up to which an axis lies on what is level.
constexpr double level = 0.05;
/// Cosine by which a direction counts as the normal of a face.
constexpr double of_a_face = 1 - 1e-9;

Vec3 seen_from_body(const Pose& pose, const Vec3& world) {
    return rotated_back(pose.rotation, world - pose.translation);
}

bool in_box(const Facet& f, const Vec3& p, double around) {
    return p.x >= f.low.x - around && p.x <= f.high.x + around && p.y >= f.low.y - around && p.y <= f.high.y + around
           && p.z >= f.low.z - around && p.z <= f.high.z + around;
}

constexpr std::size_t few = 64; // facets

/// In the order of their boxes along the axis that tells most of them apart.
void sort_facets(Site& site) {
    site.widest = std::numeric_limits<double>::infinity();
    if (site.facets.size() <= few) return;
    Vec3 low = site.facets[0].low, high = low;
    for (const Facet& f : site.facets) low = least(low, f.low), high = most(high, f.low);
    const Vec3 size = high - low;
    site.sorted_along = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto at = [&](const Vec3& v) { return raycontact::axis(v, site.sorted_along); };
    std::ranges::stable_sort(site.facets, {}, [&](const Facet& f) { return at(f.low); });
    site.widest = 0;
    for (const Facet& f : site.facets) site.widest = std::max(site.widest, at(f.high) - at(f.low));
}

/// Whether any facet whose box is so near to a point is as asked for.
template <class Is>
bool any_beside(const Site& site, const Vec3& p, double near, Is&& is) {
    const bool is_sorted = site.facets.size() > few;
    const auto at = [&](const Vec3& v) { return raycontact::axis(v, site.sorted_along); };
    auto f = site.facets.begin();
    if (is_sorted)
        f = std::ranges::lower_bound(site.facets, at(p) - near - site.widest, {},
                                     [&](const Facet& g) { return at(g.low); });
    for (; f != site.facets.end() && !(is_sorted && at(f->low) > at(p) + near); ++f)
        if (in_box(*f, p, near) && is(*f)) return true;
    return false;
}

/// Of a facet as seen from a point of it: 2 pi within, pi on an edge.
double angle_at(const Facet& f, unsigned on) {
    if (on == 7) return 2 * std::numbers::pi;
    if ((on & (on - 1)) != 0) return std::numbers::pi;
    const std::size_t k = on >> 1;
    return corner_angles(f.corner)[k];
}

/// Spots of one obstacle, each place once. Of two at one place that of a face counts: an edge may yet be a step.
class SpotList {
public:
    SpotList(std::vector<Spot>& spots, double limit) : spots_(spots), apart_(one_place * limit) {}
    void add(const Spot& spot) {
        const auto end = by_x_.upper_bound(spot.point.x + apart_);
        for (auto known = by_x_.lower_bound(spot.point.x - apart_); known != end; ++known) {
            Spot& s = spots_[known->second];
            if (!(length2(s.point - spot.point) < apart_ * apart_ && s.away * spot.away > 0)) continue;
            if (spot.flat && !s.flat) s = spot; // its key stays: it is at the same place
            return;
        }
        by_x_.emplace(spot.point.x, spots_.size());
        spots_.push_back(spot);
    }

private:
    std::vector<Spot>& spots_;
    double apart_;
    std::multimap<double, std::size_t> by_x_;
};
std::vector<SpotList> lists_of(std::vector<std::vector<Spot>>& spots, double limit) {
    std::vector<SpotList> lists;
    lists.reserve(spots.size());
    for (std::vector<Spot>& own : spots) lists.emplace_back(own, limit);
    return lists;
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
        sort_facets(site);
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

void Surroundings::deflect(const Spot& spot) {
    const double into = dot(way(spot.obstacle, spot.at), spot.normal);
    if (into >= 0) return;
    const Site& site = sites_[spot.obstacle];
    const RodPush push(site.from[1] - site.from[0], round_.radius, spot.at, spot.normal);
    const double metres = push.needed(-into);
    for (int e = 0; e < 2; ++e) {
        const Vec3 back = rotated(site.pose.rotation, metres * push.moved(e));
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
    const Spot spot{.obstacle = obstacle, .at = at, .point = point};
    return !is_nearer_there(spot, part, length2(axis(obstacle, at, part) - point) * (1 - rounding));
}

// Whether a facet that goes on beside a spot is nearer to the axis than this, squared.
bool Surroundings::is_nearer_there(const Spot& spot, double part, double than2) const {
    const double near = beside(spot.obstacle);
    for (std::size_t k = 0; k < sites_.size(); ++k) {
        const Vec3 p = seen_from(k, spot.obstacle, spot.point, spot.at, part), centre = axis(k, spot.at, part);
        if (any_beside(sites_[k], p, near, [&](const Facet& f) {
                return nearest(f, centre).away2 < than2 && nearest(f, p).away2 <= near * near;
            }))
            return true;
    }
    return false;
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
        if (any_beside(sites_[k], p, near, [&](const Facet& f) {
                const Nearest below = nearest(f, p);
                if (below.away2 > near * near) return false;
                const double from = length2(below.point - centre);
                return nearest(f, centre).away2 < from * (1 - rounding);
            }))
            return true;
    }
    return false;
}

// Whether the surface goes on beside a capsule, to either side: no farther away than by so much of the way there.
std::array<bool, 2> Surroundings::goes_on(const Spot& spot, double part, double slope) const {
    // Beyond an edge the distance grows by half the square of the way: that must be more than the slope allows.
    const double aside = std::max(0.01, 4 * slope) * spot.away, near = aside + beside(spot.obstacle),
                 most = spot.away + slope * aside;
    std::array<bool, 2> found{};
    for (std::size_t k = 0; k < sites_.size(); ++k) {
        const Vec3 p = seen_from(k, spot.obstacle, spot.point, spot.at, part), centre = axis(k, spot.at, part);
        const Vec3 along = axis(k, 1, part) - axis(k, 0, part);
        const Vec3 step = (aside / length(along)) * along;
        any_beside(sites_[k], p, near, [&](const Facet& f) {
            for (const std::size_t side : {0, 1}) {
                const Vec3 beside_it = side == 0 ? centre - step : centre + step;
                found[side] = found[side] || nearest(f, beside_it).away2 <= most * most * (1 + 1e-9);
            }
            return found[0] && found[1];
        });
    }
    return found;
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
        any_beside(site, spot.point, here, [&](const Facet& f) {
            const Nearest n = nearest(f, spot.point);
            if (n.away2 > here * here) return false;
            out = out + angle_at(f, n.on) * f.normal;
            most = std::max(most, std::fabs(dot(f.normal, between)));
            return false;
        });
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

// Of the vertices as steps see them, not of the file's, which queries take. found: where the facet is then.
std::optional<Surroundings::Entry> Surroundings::nearest_facet(std::size_t site, const Vec3& p, double from,
                                                               std::vector<Facet>& found) const {
    const Facets& surface = sites_[site].obstacle->surface;
    const double first = std::max(2 * from, 1e-3 * surface.size());
    for (double around = first; around < 8 * (surface.size() + length(p) + first); around *= 2) {
        found.clear();
        const Vec3 more{around, around, around};
        surface.near(p - more, p + more, found);
        std::optional<Entry> best;
        for (const Facet& f : found)
            if (const Nearest n = nearest(f, p); n.away2 > 0 && (!best || n.away2 < best->away2))
                best = {n.away2, site, &f, n};
        if (best && best->away2 <= around * around) return best;
    }
    return std::nullopt;
}

void Surroundings::of_end(int end, double part, double limit, std::vector<std::vector<Spot>>& out) const {
    static thread_local std::vector<Entry> entries;
    static thread_local std::vector<Facet> beyond;
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
    std::vector<SpotList> lists = lists_of(out, limit);
    for (const Entry& e : entries) {
        if (!out[e.site].empty() && out[e.site].front().away < 0) continue; // it is inside: the nearest is all
        Spot spot{.obstacle = e.site, .part = end, .at = double(end), .point = e.nearest.point};
        // No facet that is there is nearer.
        if (e.nearest.on != 7 && is_nearer_there(spot, part, e.away2 - rounding * limit * limit)) continue;
        finish(sites_[e.site], *e.facet, e.nearest.on, axis(e.site, end, part), spot);
        lists[e.site].add(spot);
    }
    for (std::size_t k = 0; k < sites_.size(); ++k) {
        std::vector<Spot>& spots = out[k];
        const Facets& surface = sites_[k].obstacle->surface;
        if (spots.empty()) {
            // So deep inside that no surface is in reach.
            const Vec3 centre = axis(k, end, part);
            if (!surface.shape() || sites_[k].obstacle->two_sided || !contains(*surface.shape(), centre)) continue;
            const std::optional<Entry> way_out = nearest_facet(k, centre, limit, beyond);
            if (!way_out) continue;
            const double away = std::sqrt(way_out->away2);
            spots.push_back({.obstacle = k,
                             .part = end,
                             .at = double(end),
                             .point = way_out->nearest.point,
                             .normal = (1 / away) * (way_out->nearest.point - centre),
                             .away = -away,
                             .flat = true,
                             .triangle = surface.shape()->triangle_index()[way_out->facet->triangle]});
        } else if (spots[0].away < 0) { // the nearest comes first
            spots.resize(1);
        } else { // faces seen from behind belong to the far side of something thin
            std::erase_if(spots, [](const Spot& s) { return s.away < 0; });
        }
    }
}

void Surroundings::of_side(double part, double limit, std::vector<std::vector<Spot>>& out) const {
    struct Candidate {
        Entry entry; // nearest: the place on the facet
        double at;
    };
    static thread_local std::vector<Candidate> candidates;
    candidates.clear();
    // An edge across which the axis leaves a face counts, though the axis rises from there: it lies on both ends.
    constexpr double level2 = level * level;
    for (std::size_t k = 0; k < sites_.size(); ++k) {
        const Vec3 a = axis(k, 0, part), along = axis(k, 1, part) - a;
        const double length2_along = length2(along);
        for (const Facet& f : sites_[k].facets) {
            if (least_away(f, a, a + along) >= limit) continue;
            const auto consider = [&](const Vec3& p, unsigned on, double at) {
                if (!(at > 0 && at < 1)) return; // the ends see it
                const Vec3 centre = a + at * along;
                const double away2 = length2(p - centre);
                if (away2 >= limit * limit
                    || nearest(f, centre).away2 < away2 * (1 - level2) - rounding * limit * limit)
                    return;
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
        }
    }
    std::ranges::stable_sort(candidates, {}, [](const Candidate& c) { return c.entry.away2; });
    std::vector<SpotList> lists = lists_of(out, limit);
    for (const auto& [e, at] : candidates) {
        Spot spot{.obstacle = e.site, .part = 2, .at = at, .point = e.nearest.point, .away = std::sqrt(e.away2)};
        const double rounded = rounding * limit * limit;
        if (!is_nearer_there(spot, part, e.away2 - rounded)) {
            const auto [before, behind] = goes_on(spot, part, 0);
            if (before && behind) continue; // nowhere nearer: the ends of the plateau tell it
        } else {
            if (is_nearer_there(spot, part, e.away2 * (1 - level2) - rounded)) continue;
            const auto [before, behind] = goes_on(spot, part, level);
            if (before == behind) continue;
        }
        finish(sites_[e.site], *e.facet, e.nearest.on, axis(e.site, at, part), spot);
        if (spot.away > 0) lists[e.site].add(spot);
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

namespace {

/// By the side that a spot is on; of one side by its triangle.
std::tuple<int, int, int, std::uint32_t> order_of(const Spot& spot) {
    const auto rounded = [](double x) { return static_cast<int>(1e6 * x); };
    return {rounded(spot.normal.x), rounded(spot.normal.y), rounded(spot.normal.z), spot.triangle};
}

} // namespace

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
            std::ranges::stable_sort(of_part[k], {}, order_of); // numbers stay while distances and triangles change
            all.insert(all.end(), of_part[k].begin(), of_part[k].end());
        }
    for (const Spot& s : all)
        if (s.away < limit && (s.flat || s.away <= 0 || !is_step(s, all, part))) out.push_back(s);
}

} // namespace raycontact
