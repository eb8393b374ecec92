// SPDX-License-Identifier: Apache-2.0
#include "speculative/speculative_pair.h"

#include "pairs/displacement.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace raycontact {

namespace {

// Of a length, what a vertex that faces the target may look away from it, and two edges lean out of the arc between the
// normals of either one's faces; more for edges, since flush faces are never quite so.
constexpr double sideways = 1e-6, arc = 0.1;
// Edges that are more parallel have no one point where they are nearest: vertices have.
constexpr double least_sine = 1e-3;
// Of a pair that goes farther than this in a step, in diagonals of the smaller body, only edges that hide much are
// asked.
constexpr double far = 0.2;
// Edges touch, by PairEdges, from where they pass each other though both bodies are moved inward by a perturbation and
// shaken. Until they are so many perturbations deep, they are near.
constexpr double perturbations_until_touching = 2.2;

// Calls visit(edge or vertex, its near faces) for each.
template <class Visit>
void by_source(std::span<const NearEdge> near, Visit&& visit) {
    for (std::size_t begin = 0, end = 0; begin < near.size(); begin = end) {
        while (end < near.size() && near[end].edge == near[begin].edge) ++end;
        visit(near[begin].edge, near.subspan(begin, end - begin));
    }
}

Box box_of(const Vec3& p, const Vec3& q, double margin) {
    const Vec3 grown{margin, margin, margin};
    return {least(p, q) - grown, most(p, q) + grown};
}

// How a vertex comes to a face.
struct Approach {
    std::uint32_t face;
    Vec3 normal; ///< of the target, outward
    double gap;
};

// The outward direction at a point of a face's border: of an edge the mean of its faces, of a corner its normal.
Vec3 border_normal(const ShapeData& mesh, std::uint32_t face, std::uint32_t edges) {
    const auto corner_of_two = [](std::uint32_t k) { return k == 3 ? 1u : k == 6 ? 2u : 0u; };
    if ((edges & (edges - 1)) != 0) return mesh.vertex_normals[mesh.mesh.triangles[face][corner_of_two(edges)]];
    const std::uint32_t across = mesh.neighbours[face][edges == 1 ? 0 : edges == 2 ? 1 : 2];
    const Vec3 own = unit(area_normal(mesh, face));
    return across == NONE ? own : own + unit(area_normal(mesh, across));
}

// The nearest point of the target within the margin, if the vertex is outside there.
std::optional<Approach> nearest(const ShapeData& target, std::span<const NearEdge> faces, const Vec3& p, double margin,
                                double perturbation) {
    double least2 = margin * margin;
    Box within = box_of(p, p, margin);
    std::uint32_t face = NONE;
    NearestPoint best;
    for (const NearEdge& near : faces) {
        const Vec3 a = target.corner(near.face, 0), b = target.corner(near.face, 1), c = target.corner(near.face, 2);
        if (!Box{least(a, least(b, c)), most(a, most(b, c))}.touches(within)) continue;
        const NearestPoint point = nearest_of(p, a, b, c);
        const Vec3 off = p - point.point;
        const double away2 = dot(off, off);
        if (away2 > least2 || (away2 == least2 && near.face > face)) continue;
        least2 = away2;
        within = box_of(p, p, std::sqrt(least2));
        face = near.face;
        best = point;
    }
    if (face == NONE) return std::nullopt;
    const Vec3 off = p - best.point, own = unit(area_normal(target, face));
    const double gap = std::sqrt(least2);
    if (best.edges == 0) {
        if (dot(off, own) < 0) return std::nullopt;
        return Approach{face, own, gap};
    }
    const Vec3 out = border_normal(target, face, best.edges);
    if (gap <= perturbation) return Approach{face, own, gap};
    if (!(dot(off, out) > 0)) return std::nullopt;
    return Approach{face, (1 / gap) * off, gap};
}

// The first face on a vertex's way, if it comes from outside: from a perturbation behind, so that one on the surface
// counts.
std::optional<Approach> first_met(const ShapeData& target, std::span<const NearEdge> faces, const Vec3& from,
                                  const Vec3& to, double perturbation) {
    const Vec3 way = to - from;
    const double size = length(way);
    if (!(size > perturbation)) return std::nullopt;
    const Box passed = box_of(from, to, perturbation);
    double first = 1;
    std::uint32_t face = NONE;
    for (const NearEdge& near : faces) {
        const Vec3 a = target.corner(near.face, 0), b = target.corner(near.face, 1), c = target.corner(near.face, 2);
        if (!Box{least(a, least(b, c)), most(a, most(b, c))}.touches(passed)) continue;
        const Vec3 p = a - from, q = b - from, r = c - from;
        const double u = dot(cross(q, r), way), v = dot(cross(r, p), way), w = dot(cross(p, q), way);
        if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))) continue;
        const double volume = u + v + w;
        if (volume == 0) continue;
        const double at = (u * dot(p, way) + v * dot(q, way) + w * dot(r, way)) / (volume * size * size);
        if (at < -perturbation / size || at > first || (at == first && near.face > face)) continue;
        first = at;
        face = near.face;
    }
    if (face == NONE) return std::nullopt;
    const Vec3 out = unit(area_normal(target, face));
    if (!(dot(way, out) < 0)) return std::nullopt;
    return Approach{face, out, std::max(0.0, dot(from - target.corner(face, 0), out))};
}

// By how much a unit direction leaves the arc between the normals of a convex edge's faces; of a border the half plane
// above its face. along: the edge, unit, as its own face runs about it; turn: turns the mesh's normals.
template <class Turn>
double beyond_arc(const ShapeData& mesh, std::uint32_t edge, const Vec3& along, const Vec3& direction, Turn&& turn) {
    const auto [own, across] = faces_of(mesh, edge);
    const Vec3 n = turn(unit(area_normal(mesh, own)));
    const double inward = dot(direction, cross(n, along));
    if (across == NONE) return std::max(inward, -dot(direction, n));
    return std::max(inward, -dot(direction, cross(turn(unit(area_normal(mesh, across))), along)));
}

// Where the lines of two edges are nearest, from 0 to 1 of each; empty unless both points are within them.
std::optional<std::array<double, 2>> nearest_within(const Vec3& p, const Vec3& along, const Vec3& q,
                                                    const Vec3& other) {
    const double a = dot(along, along), b = dot(along, other), c = dot(other, other), whole = a * c - b * b;
    if (!(whole > least_sine * least_sine * a * c)) return std::nullopt;
    const Vec3 apart = q - p;
    const double d = dot(along, apart), e = dot(other, apart);
    const double s = (c * d - b * e) / whole, u = (b * d - a * e) / whole;
    if (!(s >= 0 && s <= 1 && u >= 0 && u <= 1)) return std::nullopt;
    return std::array{s, u};
}

// When the lines of a moving edge and a resting one meet, parts of the step, in order: the volume of the two edges is
// 0.
std::array<double, 2> meetings(const Vec3& along, const Vec3& turn, const Vec3& other, const Vec3& apart,
                               const Vec3& way) {
    const Vec3 x = cross(along, other), dx = cross(turn, other);
    const double f0 = dot(x, apart), f1 = dot(dx, apart) - dot(x, way), f2 = -dot(dx, way);
    constexpr double never = 2;
    if (f2 == 0) return {f1 == 0 ? never : -f0 / f1, never};
    const double root2 = f1 * f1 - 4 * f2 * f0;
    if (!(root2 >= 0)) return {never, never};
    const double part = -0.5 * (f1 + (f1 < 0 ? -1 : 1) * std::sqrt(root2));
    const double one = part / f2, two = part == 0 ? never : f0 / part;
    return {std::min(one, two), std::max(one, two)};
}

struct Edge {
    std::array<Vec3, 2> ends, ways; ///< until the next step
};

/// One body as the other sees it, in the other's centred frame.
struct OneWay {
    const ShapeData &source, &target;
    Pose now, next;
    bool moves; ///< a point may go farther than the margin until the next step
};

std::array<OneWay, 2> sides_of(const SpeculativePair& pair) {
    const ShapeData &a = pair.a.shape->data(), &b = pair.b.shape->data();
    return {OneWay{a, b, pair.now.pose, pair.next.pose, pair.ways[0] > pair.margin},
            OneWay{b, a, pair.now.pose_of_second(), pair.next.pose_of_second(), pair.ways[1] > pair.margin}};
}

double perturbation_of(const SpeculativePair& pair) {
    return 1e-7 * smaller_size(pair.a, pair.b);
}

} // namespace

SpeculativePair::SpeculativePair(const PlacedBody& first, const PlacedBody& second, double within)
    : a(first), b(second), margin(within), now(place_pair(a.centred, b.centred, 0)),
      next(place_pair(a.next, b.next, 0)),
      ways(displacement_bounds(now, next, a.shape->data().reach, b.shape->data().reach)) {}

void find_speculative_vertices(const SpeculativePair& pair, const NearEdges& near,
                               const std::array<std::span<const std::uint32_t>, 2>& touching,
                               std::vector<FeatureContact>& found) {
    const double perturbation = perturbation_of(pair);
    const auto sides = sides_of(pair);
    for (const Side body : {Side::a, Side::b}) {
        const auto own = static_cast<std::size_t>(body);
        const OneWay& side = sides[own];
        by_source(near[own], [&](std::uint32_t v, std::span<const NearEdge> faces) {
            if (std::ranges::binary_search(touching[own], v)) return;
            const Vec3 point = side.source.point(v), p = transform_point(side.now, point);
            std::optional<Approach> approach;
            if (side.moves)
                approach = first_met(side.target, faces, p, transform_point(side.next, point), perturbation);
            if (!approach) {
                approach = nearest(side.target, faces, p, pair.margin, perturbation);
                const Vec3 outward = rotated(side.now.rotation, side.source.vertex_normals[v]);
                if (!approach || !(dot(outward, approach->normal) < -sideways)) return;
            }
            found.push_back({body, FeatureKind::vertex, v, approach->face, p, approach->normal, -approach->gap});
        });
    }
}

// Of a's edges against b's. An edge is asked with the lowest of its faces.
void find_speculative_edges(const SpeculativePair& pair, bool told, const NearEdges& near,
                            std::vector<FeatureContact>& found) {
    const OneWay side = sides_of(pair)[0];
    const ShapeData &a = side.source, &b = side.target;
    const double size = smaller_size(pair.a, pair.b), perturbation = perturbation_of(pair);
    const bool few = told || std::ranges::max(pair.ways) > far * size;
    if (few && !hides_more(pair.a, pair.b, least_hidden_beside)) return;
    const double hidden = few ? least_hidden_beside * size : -1;
    const std::size_t touching = found.size();
    const auto touches = [&](std::uint32_t edge, std::uint32_t other) {
        return std::any_of(found.begin(), found.begin() + std::ptrdiff_t(touching), [&](const FeatureContact& c) {
            return c.kind == FeatureKind::edges && c.index == edge && c.other == other;
        });
    };
    const auto stays = [](const Vec3& n) { return n; };
    const auto turned = [&](const Vec3& n) { return rotated(side.now.rotation, n); };
    by_source(near[0], [&](std::uint32_t number, std::span<const NearEdge> faces) {
        const auto [start, stop] = ends_of(a, number);
        if (!is_sharp(a, number) || !(hidden_by(a, number) > hidden) || !is_convex(a, number)) return;
        Edge edge{{transform_point(side.now, a.point(start)), transform_point(side.now, a.point(stop))}, {}};
        if (side.moves)
            edge.ways = {transform_point(side.next, a.point(start)) - edge.ends[0],
                         transform_point(side.next, a.point(stop)) - edge.ends[1]};
        const Vec3 along = edge.ends[1] - edge.ends[0];
        Box box = box_of(edge.ends[0], edge.ends[1], pair.margin);
        const Box then = box_of(edge.ends[0] + edge.ways[0], edge.ends[1] + edge.ways[1], pair.margin);
        box = {least(box.low, then.low), most(box.high, then.high)};
        for (const NearEdge& one : faces)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t other = 3 * one.face + k;
                if (!is_sharp(b, other)) continue; // nor if another face is lower
                const Vec3 q = b.corner(one.face, k), beside = b.corner(one.face, (k + 1) % 3) - q;
                if (!box.touches(box_of(q, q + beside, 0)) || !(hidden_by(b, other) > hidden)) continue;
                const auto gap_along = [&](const Vec3& n, const std::array<double, 2>& at) {
                    return dot(n, edge.ends[0] + at[0] * along - (q + at[1] * beside));
                };
                const auto is_in_arcs = [&](const Vec3& n, const Vec3& direction) {
                    return is_convex(b, other) && beyond_arc(b, other, unit(beside), n, stays) <= arc
                           && beyond_arc(a, number, unit(direction), -1.0 * n, turned) <= arc;
                };
                const auto tell = [&](const Vec3& n, const std::array<double, 2>& at) {
                    if (touches(number, other)) return;
                    found.push_back({Side::a, FeatureKind::edges, number, other, edge.ends[0] + at[0] * along, n,
                                     -std::max(0.0, gap_along(n, at))});
                };
                const auto will_meet = [&] {
                    const Vec3 turn = edge.ways[1] - edge.ways[0];
                    for (const double t : meetings(along, turn, beside, q - edge.ends[0], edge.ways[0])) {
                        if (!(t >= 0 && t <= 1)) continue;
                        const Vec3 direction = along + t * turn;
                        const auto at = nearest_within(edge.ends[0] + t * edge.ways[0], direction, q, beside);
                        if (!at) continue;
                        Vec3 n = unit(cross(direction, beside));
                        const double lean = dot(n, edge.ways[0] + (*at)[0] * turn);
                        if (lean > 0) n = -1.0 * n;
                        if (lean == 0 || !is_in_arcs(n, direction)) continue;
                        tell(n, *at);
                        return true;
                    }
                    return false;
                };
                if (side.moves && will_meet()) continue;
                const auto at = nearest_within(edge.ends[0], along, q, beside);
                if (!at) continue;
                Vec3 n = unit(cross(along, beside));
                const auto [own, across] = faces_of(b, other);
                Vec3 out = unit(area_normal(b, own));
                if (across != NONE) out = out + unit(area_normal(b, across));
                if (dot(n, out) < 0) n = -1.0 * n;
                const double gap = gap_along(n, *at);
                if (gap >= -perturbations_until_touching * perturbation && gap <= pair.margin && is_in_arcs(n, along))
                    tell(n, *at);
            }
    });
}

} // namespace raycontact
