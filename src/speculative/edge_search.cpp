// SPDX-License-Identifier: Apache-2.0
#include "speculative/edge_search.h"

#include "speculative/approach.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace raycontact {

namespace {

// Of a length, what a direction may lean out of the arc between the normals of either edge's faces: flush faces are
// never quite so.
constexpr double arc = 0.1;
// Edges that are more parallel have no one point where they are nearest: vertices have.
constexpr double least_sine = 1e-3;
// Edges touch, by PairEdges, from where they pass each other though both bodies are moved inward by perturbations and
// shaken. Until they are so many perturbations deep, they are near.
constexpr double perturbations_until_touching = 4.4;

/// A sharp edge, where it is and how its ends move until the next step. The target's do not.
struct Edge {
    std::uint32_t number;
    std::array<Vec3, 2> ends, ways;

    Vec3 along(double t) const { return ends[1] - ends[0] + t * (ways[1] - ways[0]); }
    Vec3 point(double at) const { return ends[0] + at * (ends[1] - ends[0]); }
    Vec3 way(double at) const { return ways[0] + at * (ways[1] - ways[0]); }
};

/// The outward normals of an edge's faces, unit; a border has one.
struct EdgeNormals {
    std::array<Vec3, 2> of_faces;
    bool border;

    EdgeNormals(const ShapeData& shape, std::uint32_t edge) {
        const auto [own, across] = faces_of(shape, edge);
        border = across == NONE;
        of_faces[0] = unit(area_normal(shape, own));
        of_faces[1] = border ? of_faces[0] : unit(area_normal(shape, across));
    }
    /// Of the moving body's, after a part of the step, in the target's frame.
    EdgeNormals turned(const OneWay& body, double t) const {
        EdgeNormals there = *this;
        for (Vec3& n : there.of_faces) {
            const Vec3 now = rotated(body.now.rotation, n);
            n = t > 0 ? part_of_turn(now, rotated(body.next.rotation, n), t) : now;
        }
        return there;
    }
    /// By how much a unit direction leaves the arc between them; of a border the half plane above its face. along: the
    /// edge, unit, as its own face runs about it.
    double beyond_arc(const Vec3& along, const Vec3& direction) const {
        const double inward = dot(direction, cross(of_faces[0], along));
        return std::max(inward, -dot(direction, border ? of_faces[0] : cross(of_faces[1], along)));
    }
};

/// Where the lines of two edges are nearest, from 0 to 1 of each.
using Places = std::array<double, 2>;
// Empty unless both points are within them.
std::optional<Places> nearest_within(const Vec3& p, const Vec3& along, const Vec3& q, const Vec3& other) {
    const double a = dot(along, along), b = dot(along, other), c = dot(other, other), whole = a * c - b * b;
    if (!(whole > least_sine * least_sine * a * c)) return std::nullopt;
    const Vec3 apart = q - p;
    const double d = dot(along, apart), e = dot(other, apart);
    const double s = (c * d - b * e) / whole, u = (b * d - a * e) / whole;
    if (!(s >= 0 && s <= 1 && u >= 0 && u <= 1)) return std::nullopt;
    return Places{s, u};
}

// When the lines of a moving edge and a resting one meet, parts of the step, in order: the volume of the two edges is
// 0.
std::array<double, 2> meetings(const Edge& edge, const Edge& rests) {
    const Vec3 turn = edge.ways[1] - edge.ways[0], other = rests.along(0), apart = rests.ends[0] - edge.ends[0];
    const Vec3 x = cross(edge.along(0), other), dx = cross(turn, other);
    const double f0 = dot(x, apart), f1 = dot(dx, apart) - dot(x, edge.ways[0]), f2 = -dot(dx, edge.ways[0]);
    constexpr double never = 2;
    if (f2 == 0) return {f1 == 0 ? never : -f0 / f1, never};
    const double root2 = f1 * f1 - 4 * f2 * f0;
    if (!(root2 >= 0)) return {never, never};
    const double part = -0.5 * (f1 + (f1 < 0 ? -1 : 1) * std::sqrt(root2));
    const double one = part / f2, two = part == 0 ? never : f0 / part;
    return {std::min(one, two), std::max(one, two)};
}

Edge edge_of(const ShapeData& shape, std::uint32_t number) {
    const auto [start, stop] = ends_of(shape, number);
    return {number, {shape.point(start), shape.point(stop)}, {}};
}

Edge edge_of_a(const OneWay& body, std::uint32_t number) {
    Edge edge = edge_of(body.source, number);
    for (std::size_t k = 0; k < 2; ++k) {
        const Vec3 end = std::exchange(edge.ends[k], transform_point(body.now, edge.ends[k]));
        if (body.moves) edge.ways[k] = transform_point(body.next, end) - edge.ends[k];
    }
    return edge;
}

// Of the faces of either edge, one that averts the contact and changes the motion less stands for it, if the other edge
// is above it as a whole, or below by no more than the margin; and ends within the margin, or glances along it.
void change_least(const SpeculativePair& pair, FeatureContact& contact, const Edge& edge, const Edge& other,
                  const Places& at) {
    const OneWay& body = pair.bodies[0];
    const Vec3 way = edge.way(at[0]);
    double passed = passed_by(contact.normal, -contact.depth, way);
    if (!(passed > 0)) return;
    const auto ask = [&](const Vec3& n, const Places& gaps, const Places& past, const Edge& ends) {
        const std::size_t k = past[0] > past[1] ? 0 : 1;
        const double away = length(ends.ends[k] - ends.point(&ends == &edge ? at[0] : at[1]));
        if (away > pair.margin && past[k] > glancing * passed) return;
        if (!(std::min(gaps[0], gaps[1]) > -pair.margin) || !(past[k] < passed)) return;
        passed = past[k];
        contact.point = &ends == &edge ? ends.ends[k] : ends.ends[k] + gaps[k] * n;
        contact.normal = n;
        contact.depth = -gaps[k];
    };
    const EdgeNormals of_b(body.target, other.number);
    for (const Vec3& n : of_b.of_faces) {
        const auto gap = [&](std::size_t k) { return dot(n, edge.ends[k] - other.ends[0]); };
        const auto past = [&](std::size_t k) { return passed_by(n, gap(k), edge.ways[k]); };
        ask(n, {gap(0), gap(1)}, {past(0), past(1)}, edge);
    }
    const EdgeNormals of_a = EdgeNormals(body.source, edge.number).turned(body, 0);
    for (const Vec3& n : of_a.of_faces) {
        const auto gap = [&](std::size_t k) { return dot(n, other.ends[k] - edge.ends[0]); };
        const auto past = [&](std::size_t k) { return passed_by(-1.0 * n, gap(k), way); };
        ask(-1.0 * n, {gap(0), gap(1)}, {past(0), past(1)}, other);
    }
}

class Search {
public:
    Search(const SpeculativePair& pair, double least, std::vector<FeatureContact>& found)
        : pair_(pair), body_(pair.bodies[0]), least_(least), ahead_(least_hidden_ahead(pair.a, pair.b, pair.margin)),
          from_both_(seeks_what_hides(pair.a, pair.b, pair.margin)), found_(found), touching_(found.size()) {}

    void find(const NearEdges& near) {
        by_source(near[0], [&](std::uint32_t number, std::span<const NearEdge> faces) {
            const bool is_near = !from_both_ || hidden_by(body_.source, number) > ahead_;
            if ((is_near || body_.moves) && counts(body_.source, number))
                find(edge_of_a(body_, number), is_near, faces);
        });
        if (!from_both_) return;
        by_source(near[1], [&](std::uint32_t number, std::span<const NearEdge> faces) {
            if (hidden_by(body_.target, number) > ahead_ && counts(body_.target, number))
                find_small(edge_of(body_.target, number), faces);
        });
    }

private:
    // An edge is asked with the lowest of its faces.
    bool counts(const ShapeData& shape, std::uint32_t edge) const {
        return is_sharp(shape, edge) && hidden_by(shape, edge) > least_ && is_convex(shape, edge);
    }
    // Whether two edges hide enough to have a contact while they are near.
    bool hide(std::uint32_t edge, std::uint32_t other) const {
        return hidden_by(body_.source, edge) * hidden_by(body_.target, other) > ahead_ * ahead_;
    }

    // is_near: edges of b may be near, too; else it may meet some.
    void find(const Edge& edge, bool is_near, std::span<const NearEdge> faces) {
        Box box = box_of(edge.ends[0], edge.ends[1], pair_.margin);
        const Box then = box_of(edge.ends[0] + edge.ways[0], edge.ends[1] + edge.ways[1], pair_.margin);
        box = {least(box.low, then.low), most(box.high, then.high)};
        for (const NearEdge& one : faces)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t number = 3 * one.face + k;
                const ShapeData& b = body_.target;
                if (!is_sharp(b, number) || !(hidden_by(b, number) > least_)) continue; // nor if another face is lower
                const Edge other = edge_of(b, number);
                if (!box.touches(box_of(other.ends[0], other.ends[1], 0))) continue;
                if (const auto meeting = meeting_of(edge, other))
                    tell(edge, other, meeting->when, meeting->at, meeting->normal);
                else if (is_near && hide(edge.number, number))
                    find_near(edge, other);
            }
    }

    // Of an edge of b those of a that hide little.
    void find_small(const Edge& other, std::span<const NearEdge> faces) {
        const Box box = box_of(other.ends[0], other.ends[1], pair_.margin);
        for (const NearEdge& one : faces)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t number = 3 * one.face + k;
                if (hidden_by(body_.source, number) > ahead_ || !hide(number, other.number)) continue;
                if (!counts(body_.source, number)) continue;
                const Edge edge = edge_of_a(body_, number);
                if (box.touches(box_of(edge.ends[0], edge.ends[1], 0)) && !meeting_of(edge, other))
                    find_near(edge, other);
            }
    }

    bool touches(std::uint32_t edge, std::uint32_t other) const {
        return std::any_of(found_.begin(), found_.begin() + std::ptrdiff_t(touching_), [&](const FeatureContact& c) {
            return c.kind == FeatureKind::edges && c.index == edge && c.other == other;
        });
    }

    // n: out of b, after a part t of the step.
    bool is_in_arcs(const Edge& edge, const Edge& other, double t, const Vec3& n) const {
        return is_convex(body_.target, other.number)
               && EdgeNormals(body_.target, other.number).beyond_arc(unit(other.along(0)), n) <= arc
               && EdgeNormals(body_.source, edge.number).turned(body_, t).beyond_arc(unit(edge.along(t)), -1.0 * n)
                      <= arc;
    }

    /// Where a moving edge meets a resting one.
    struct Meeting {
        double when; ///< part of the step
        Places at;
        Vec3 normal; ///< out of b
    };
    std::optional<Meeting> meeting_of(const Edge& edge, const Edge& other) const {
        if (!body_.moves) return std::nullopt;
        for (const double t : meetings(edge, other)) {
            if (!(t >= 0 && t <= 1)) continue;
            const Vec3 along = edge.along(t);
            const auto at = nearest_within(edge.ends[0] + t * edge.ways[0], along, other.ends[0], other.along(0));
            if (!at) continue;
            const Vec3 n = unit(cross(along, other.along(0)));
            const double lean = dot(n, edge.way((*at)[0]));
            const Vec3 out = lean > 0 ? -1.0 * n : n;
            if (lean != 0 && is_in_arcs(edge, other, t, out)) return Meeting{t, *at, out};
        }
        return std::nullopt;
    }

    void find_near(const Edge& edge, const Edge& other) {
        const Vec3 along = edge.along(0), x = cross(along, other.along(0));
        const double volume = dot(x, other.ends[0] - edge.ends[0]);
        if (volume * volume > pair_.margin * pair_.margin * dot(x, x)) return; // their lines are farther apart
        const auto at = nearest_within(edge.ends[0], along, other.ends[0], other.along(0));
        if (!at) return;
        Vec3 n = unit(x);
        double gap = dot(n, edge.point((*at)[0]) - other.point((*at)[1]));
        if (std::fabs(gap) > pair_.margin) return;
        const std::array<Vec3, 2> normals = EdgeNormals(body_.target, other.number).of_faces;
        if (dot(n, normals[0] + normals[1]) < 0) {
            n = -1.0 * n;
            gap = -gap;
        }
        if (gap >= -perturbations_until_touching * pair_.perturbation && is_in_arcs(edge, other, 0, n))
            tell(edge, other, 0, *at, n);
    }

    void tell(const Edge& edge, const Edge& other, double t, const Places& at, const Vec3& n) {
        if (touches(edge.number, other.number)) return;
        const double gap = std::max(0.0, dot(n, edge.point(at[0]) - other.point(at[1])));
        FeatureContact contact{Side::a, FeatureKind::edges, edge.number, other.number, edge.point(at[0]), n, -gap, t};
        change_least(pair_, contact, edge, other, at);
        contact.depth = std::min(0.0, contact.depth);
        found_.push_back(contact);
    }

    const SpeculativePair& pair_;
    const OneWay& body_;
    double least_;   ///< metres: edges that hide less are not asked
    double ahead_;   ///< least_hidden_ahead()
    bool from_both_; ///< seeks_what_hides()
    std::vector<FeatureContact>& found_;
    std::size_t touching_; ///< of found_: what was there
};

} // namespace

void change_least(const SpeculativePair& pair, FeatureContact& contact) {
    const OneWay& body = pair.bodies[0];
    if (!body.moves || contact.depth > pair.margin) return;
    const Edge edge = edge_of_a(body, contact.index), other = edge_of(body.target, contact.other);
    const auto at = [](const Edge& e, const Vec3& p) {
        const Vec3 along = e.along(0);
        return std::clamp(dot(p - e.ends[0], along) / dot(along, along), 0.0, 1.0);
    };
    change_least(pair, contact, edge, other, {at(edge, contact.point), at(other, contact.point)});
}

void find_speculative_edges(const SpeculativePair& pair, const NearEdges& near, double least,
                            std::vector<FeatureContact>& found) {
    Search(pair, least, found).find(near);
}

} // namespace raycontact
