// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "property/shapes.h"
#include "reference/ray.h"
#include "reference/side.h"
#include "reference/solid_edges.h"
#include "reference/vector.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>

namespace raycontact::reference {

// What speculative contacts a pair has (docs/internals/speculative.md), by brute force and in double: each vertex's
// straight way and its distance from every triangle, each edge against each other.

inline Vec3 to_local(const Subject& subject, const Pose& pose, const Vec3& world) {
    return rotate_back(pose, world - pose.translation) - subject.solid.centre;
}
inline Vec3 to_world(const Subject& subject, const Pose& pose, const Vec3& local) {
    return rotate(pose, local + subject.solid.centre) + pose.translation;
}

/// One body seen from another, in the other's frame about its centre, now and at the next step.
struct View {
    const Subject &source, &target;
    Pose now, then, target_now, target_then; ///< of the bodies, world

    Vec3 at_now(const Vec3& p) const { return to_local(target, target_now, to_world(source, now, p)); }
    Vec3 at_then(const Vec3& p) const { return to_local(target, target_then, to_world(source, then, p)); }
    Vec3 turned(const Vec3& n) const { return rotate_back(target_now, rotate(now, n)); }
    double size() const { return std::min(source.solid.diagonal, target.solid.diagonal); }
    /// The bound by which a pair hurries (docs/internals/speculative.md).
    double way() const {
        double turn = 0;
        for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
            const Vec3 by = (at_then(axis) - at_then({})) - (at_now(axis) - at_now({}));
            turn += dot(by, by);
        }
        double reach = 0;
        for (const Vec3& v : source.solid.vertices) reach = std::max(reach, length(v));
        return length(at_then({}) - at_now({})) + std::sqrt(turn / 2) * reach;
    }
};

/// What a vertex, or an edge with another, is expected to have.
struct Expected {
    double gap = 0;
    Vec3 normal; ///< out of the target, its frame
    Vec3 point;  ///< of the source, the target's frame
};
/// By the numbers of the file: a vertex and 0, or two edges.
using Key = std::pair<std::uint32_t, std::uint32_t>;
struct Expectation {
    std::map<Key, Expected> sure;
    std::set<Key> doubtful; ///< close to where the answer changes
};

inline Vec3 nearest_of_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 along = b - a;
    return a + std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0) * along;
}

inline Vec3 nearest_of_triangle(const Solid& solid, std::uint32_t t, const Vec3& p) {
    const auto& [i, j, k] = solid.triangles[t];
    const Vec3 &a = solid.vertices[i], &b = solid.vertices[j], &c = solid.vertices[k], &n = solid.face_normals[t];
    const Vec3 q = p - dot(p - a, n) * n;
    if (dot(cross(b - a, q - a), n) >= 0 && dot(cross(c - b, q - b), n) >= 0 && dot(cross(a - c, q - c), n) >= 0)
        return q;
    Vec3 best = nearest_of_segment(p, a, b);
    for (const Vec3& other : {nearest_of_segment(p, b, c), nearest_of_segment(p, c, a)})
        if (length(p - other) < length(p - best)) best = other;
    return best;
}

class Vertices {
public:
    Vertices(const View& view, double margin) : view_(view), margin_(margin), caster_(view.target.solid) {}

    /// touching: vertices of the file in contact, which have no other.
    Expectation expect(const std::set<std::uint32_t>& touching) {
        Expectation found;
        const Solid& source = view_.source.solid;
        const double way = view_.way();
        for (std::size_t v = 0; v < source.vertices.size(); ++v) {
            const Key key{source.vertex_index[v], 0};
            if (touching.contains(key.first)) continue;
            const Vec3 p = view_.at_now(source.vertices[v]);
            bool sure = std::abs(way - margin_) > 1e-7;
            if (source.exits[v] > 0) { // others cast no ray and have no contact of any kind
                const auto one = ask(v, p, way > margin_, sure);
                if (one && sure) found.sure[key] = *one;
            }
            if (!sure) found.doubtful.insert(key);
        }
        return found;
    }

private:
    std::optional<Expected> ask(std::size_t v, const Vec3& p, bool moves, bool& sure) {
        const Solid& target = view_.target.solid;
        const double perturbation = 3e-7 * view_.size();
        if (moves) {
            const Vec3 to = view_.at_then(view_.source.solid.vertices[v]), direction = unit(to - p);
            const double way = length(to - p);
            const Hit hit = caster_.closest(p, direction), behind = caster_.closest(p, -direction);
            if (behind.distance < perturbation || hit.distance < perturbation
                || std::abs(hit.distance - way) < perturbation)
                sure = false;
            if (hit.triangle != Hit::none && hit.distance <= way && !hit.from_inside) {
                const Vec3& n = target.face_normals[hit.triangle];
                if (-dot(n, direction) < 1e-5) sure = false;
                return Expected{dot(p - target.vertices[target.triangles[hit.triangle][0]], n), n, p};
            }
        }
        double least = std::numeric_limits<double>::infinity();
        Vec3 at{};
        for (std::uint32_t t = 0; t < target.triangles.size(); ++t) {
            const Vec3 q = nearest_of_triangle(target, t, p);
            if (length(p - q) >= least) continue;
            least = length(p - q);
            at = q;
        }
        if (std::abs(least - margin_) < perturbation || least < 10 * perturbation) sure = false;
        if (least > margin_) return std::nullopt;
        const Vec3 n = unit(p - at);
        const double facing = dot(view_.turned(view_.source.solid.vertex_normals[v]), n);
        const double side = side_of(p, at);
        if (std::abs(facing) < 1e-4 || std::abs(side) < 0.1) sure = false;
        if (!(facing < 0) || !(side > 0)) return std::nullopt;
        return Expected{least, n, p};
    }

    // Positive outside; by what is nearest. Of closed targets exact.
    double side_of(const Vec3& p, const Vec3& at) const {
        const Solid& target = view_.target.solid;
        if (target.closed) return winding_number(target, p) < 0.5 ? 1 : -1;
        Vec3 sum{};
        for (std::uint32_t t = 0; t < target.triangles.size(); ++t)
            if (length(at - nearest_of_triangle(target, t, at)) < 1e-9 * target.diagonal)
                sum = sum + target.face_normals[t];
        return dot(unit(p - at), unit(sum));
    }

    const View& view_;
    double margin_;
    RayCaster caster_;
};

/// Of a's edges against b's, in b's frame.
class Edges {
public:
    Edges(const View& view, double margin, bool told)
        : view_(view), margin_(margin), least_(told || view.way() > 0.2 * view.size() ? 0.1 * view.size() : -1) {}

    Expectation expect(const std::set<Key>& touching) const {
        Expectation found;
        const auto own = edges_of(view_.source.solid), other = edges_of(view_.target.solid);
        const double way = view_.way();
        for (const Edge& e : own)
            for (const Edge& g : other) {
                const Key key{e.number, g.number};
                if (touching.contains(key) || !asked(e) || !asked(g)) continue;
                bool sure = std::abs(way - margin_) > 1e-7;
                const auto one = ask(e, g, way > margin_, sure);
                if (one && sure) found.sure[key] = *one;
                if (!sure) found.doubtful.insert(key);
            }
        return found;
    }

private:
    bool asked(const Edge& e) const { return e.sharp && !e.concave && e.hides > least_; }

    /// Of an edge at part t of the step.
    struct Segment {
        Vec3 from, along;
    };
    Segment place(const Edge& e, double t) const {
        const auto at = [&](std::uint32_t v) {
            const Vec3 p = view_.at_now(view_.source.solid.vertices[v]);
            return p + t * (view_.at_then(view_.source.solid.vertices[v]) - p);
        };
        return {at(e.from), at(e.to) - at(e.from)};
    }

    // By how much n leaves the arc of the normals of the edge's faces; along: as the first face runs about it.
    static double beyond(const Vec3& n, const Vec3& along, const Vec3& own, const Vec3* across) {
        const double first = dot(n, cross(own, unit(along)));
        return across ? std::max(first, -dot(n, cross(*across, unit(along)))) : std::max(first, -dot(n, own));
    }

    bool in_arcs(const Edge& e, const Edge& g, const Vec3& n, const Vec3& along, const Vec3& other, bool& sure) const {
        const Solid &source = view_.source.solid, &target = view_.target.solid;
        const Vec3 e0 = view_.turned(source.face_normals[e.faces[0]]);
        const Vec3 e1 = e.faces[1] == none ? Vec3{} : view_.turned(source.face_normals[e.faces[1]]);
        const double by_e = beyond(-n, along, e0, e.faces[1] == none ? nullptr : &e1);
        const double by_g = beyond(n, other, target.face_normals[g.faces[0]],
                                   g.faces[1] == none ? nullptr : &target.face_normals[g.faces[1]]);
        for (const double by : {by_e, by_g})
            if (std::abs(by - 0.1) < 1e-6) sure = false;
        return by_e <= 0.1 && by_g <= 0.1;
    }

    // The parts of both lines where they are nearest; false unless within both.
    static bool nearest(const Segment& e, const Segment& g, double& s, double& u, bool& sure) {
        const Vec3 n = cross(e.along, g.along), apart = g.from - e.from;
        const double whole = dot(n, n);
        if (std::sqrt(whole) < 2e-3 * length(e.along) * length(g.along)) {
            sure = false; // nearly parallel
            return false;
        }
        s = dot(cross(apart, g.along), n) / whole;
        u = dot(cross(apart, e.along), n) / whole;
        for (const double part : {s, s - 1, u, u - 1})
            if (std::abs(part) < 1e-6) sure = false;
        return s >= 0 && s <= 1 && u >= 0 && u <= 1;
    }

    double volume(const Edge& e, const Segment& g, double t) const {
        const Segment at = place(e, t);
        return dot(cross(at.along, g.along), g.from - at.from);
    }

    // In parts of the step, by steps and halving.
    std::vector<double> meetings(const Edge& e, const Segment& g) const {
        constexpr int steps = 200;
        std::vector<double> found;
        double before = volume(e, g, 0);
        for (int i = 0; i < steps; ++i) {
            double low = double(i) / steps, high = double(i + 1) / steps;
            const double after = volume(e, g, high);
            if ((before < 0) != (after < 0)) {
                for (int k = 0; k < 60; ++k) {
                    const double middle = 0.5 * (low + high);
                    ((volume(e, g, middle) < 0) == (before < 0) ? low : high) = middle;
                }
                found.push_back(0.5 * (low + high));
            }
            before = after;
        }
        return found;
    }

    std::optional<Expected> ask(const Edge& e, const Edge& g, bool moves, bool& sure) const {
        const Solid& target = view_.target.solid;
        const Segment now = place(e, 0), next = place(e, 1);
        const Segment other{target.vertices[g.from], target.vertices[g.to] - target.vertices[g.from]};
        const double perturbation = 3e-7 * view_.size();
        double s = 0, u = 0;
        const auto told = [&](const Vec3& n) {
            const Vec3 point = now.from + s * now.along;
            return Expected{std::max(0.0, dot(n, point - (other.from + u * other.along))), n, point};
        };
        for (const double t : moves ? meetings(e, other) : std::vector<double>()) {
            const Segment then = place(e, t);
            if (!nearest(then, other, s, u, sure)) continue;
            const Vec3 way = (next.from - now.from) + s * (next.along - now.along);
            Vec3 n = unit(cross(then.along, other.along));
            if (dot(n, way) > 0) n = -n;
            if (std::abs(dot(n, way)) < perturbation) sure = false;
            if (!in_arcs(e, g, n, then.along, other.along, sure)) continue;
            if (t < 1e-4 || t > 1 - 1e-4) sure = false;
            return told(n);
        }
        if (moves && std::abs(volume(e, other, 0)) < perturbation * length(cross(now.along, other.along))) sure = false;
        if (moves && std::abs(volume(e, other, 1)) < perturbation * length(cross(next.along, other.along)))
            sure = false;
        if (!nearest(now, other, s, u, sure)) return std::nullopt;
        Vec3 n = unit(cross(now.along, other.along));
        Vec3 out = target.face_normals[g.faces[0]];
        if (g.faces[1] != none) out = out + target.face_normals[g.faces[1]];
        if (dot(n, out) < 0) n = -n;
        const double gap = dot(n, (now.from + s * now.along) - (other.from + u * other.along));
        if (std::abs(gap) < perturbation || std::abs(gap - margin_) < perturbation) sure = false;
        if (!(gap >= 0 && gap <= margin_) || !in_arcs(e, g, n, now.along, other.along, sure)) return std::nullopt;
        return told(n);
    }

    const View& view_;
    double margin_, least_;
};

} // namespace raycontact::reference
