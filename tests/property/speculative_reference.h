// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "property/shapes.h"
#include "reference/side.h"
#include "reference/solid_edges.h"
#include "reference/vector.h"

#include <algorithm>
#include <vector>

namespace raycontact::reference {

// Where two surfaces are nearest, by brute force and in double (docs/internals/speculative.md). It knows normal cones,
// not the rule.

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

/// A place of two surfaces that is locally nearest: a vertex and a point of the other surface, or points of two edges.
struct Place {
    bool edges = false;
    std::uint32_t index = 0, other = 0; ///< by the file: a vertex and 0, or two edges
    Vec3 normal;                        ///< out of the target, its frame
    double gap = 0;                     ///< metres
    bool sure = true;                   ///< the directions lie well within the normal cones of both features
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

/// What is nearest within a margin, by brute force: every vertex against every triangle, every edge against every edge,
/// with the normal cones of both features (Gauss map). tolerance: radians, nearly, by which a direction may leave them.
class NearestPlaces {
public:
    NearestPlaces(const View& view, double margin, double tolerance)
        : view_(view), margin_(margin), tolerance_(tolerance), tiny_(1e-6 * view.size()) {}

    std::vector<Place> of_vertices() const {
        const Solid &source = view_.source.solid, &target = view_.target.solid;
        std::vector<Place> found;
        for (std::uint32_t v = 0; v < source.vertices.size(); ++v) {
            const Vec3 p = view_.at_now(source.vertices[v]);
            for (std::uint32_t t = 0; t < target.triangles.size(); ++t) {
                const Vec3 q = nearest_of_triangle(target, t, p), n = unit(p - q);
                const double gap = length(p - q);
                if (gap > margin_ + tiny_ || gap < 10 * tiny_) continue; // what is nearer nearly touches
                const double by = std::max(leaves_cone_of(target, q, n), leaves_cone_at(source, v, n));
                const double turned = dot(view_.turned(source.vertex_normals[v]), n), side = side_of(p, q);
                if (by > tolerance_ || turned > -1e-7 || side < 0.01) continue;
                const bool sure = by < -1e-4 && gap < margin_ - tiny_ && turned < -1e-3 && side > 0.1;
                found.push_back({false, source.vertex_index[v], 0, n, gap, sure});
            }
        }
        return found;
    }

    /// Of the source's edges against the target's; sharp, convex ones that hide enough.
    std::vector<Place> of_edges() const {
        std::vector<Place> found;
        for (const Edge& e : edges_of(view_.source.solid))
            for (const Edge& g : edges_of(view_.target.solid))
                if (e.sharp && !e.concave && g.sharp && !g.concave && hidden(e, g) > 0.999) ask(e, g, found);
        return found;
    }

private:
    // By how much the surroundings of a point of the surface lie along n, of a length.
    static double leaves_cone_of(const Solid& solid, const Vec3& q, const Vec3& n) {
        double most = -1;
        for (std::uint32_t t = 0; t < solid.triangles.size(); ++t) {
            if (length(q - nearest_of_triangle(solid, t, q)) > 1e-9 * solid.diagonal) continue;
            for (const std::uint32_t c : solid.triangles[t]) {
                const Vec3 there = solid.vertices[c] - q;
                if (length(there) > 1e-9 * solid.diagonal && !is_in_plane(there, n))
                    most = std::max(most, dot(unit(there), n));
            }
        }
        return most;
    }
    // Within a face or along an edge a direction is at right angles, but for rounding.
    static bool is_in_plane(const Vec3& there, const Vec3& n) { return std::abs(dot(unit(there), n)) < 1e-6; }

    double leaves_cone_at(const Solid& solid, std::uint32_t v, const Vec3& n) const {
        double most = -1;
        for (const auto& triangle : solid.triangles)
            if (std::ranges::find(triangle, v) != triangle.end())
                for (const std::uint32_t w : triangle)
                    if (w != v)
                        most = std::max(most, -dot(unit(view_.turned(solid.vertices[w] - solid.vertices[v])), n));
        return most;
    }

    // Positive outside, and on the outer side of what is nearest. Of closed targets the first is exact.
    double side_of(const Vec3& p, const Vec3& at) const {
        const Solid& target = view_.target.solid;
        if (target.closed && winding_number(target, p) > 0.5) return -1;
        Vec3 sum{};
        for (std::uint32_t t = 0; t < target.triangles.size(); ++t)
            if (length(at - nearest_of_triangle(target, t, at)) < 1e-9 * target.diagonal)
                sum = sum + target.face_normals[t];
        return dot(unit(p - at), unit(sum));
    }

    // How deep two edges can be in each other, by what makes them count.
    double hidden(const Edge& e, const Edge& g) const {
        return std::sqrt(e.hides * g.hides) / (0.1 * std::min(margin_, 0.0025 * view_.size()));
    }

    void ask(const Edge& e, const Edge& g, std::vector<Place>& found) const {
        const Solid &source = view_.source.solid, &target = view_.target.solid;
        const Vec3 p = view_.at_now(source.vertices[e.from]), along = view_.at_now(source.vertices[e.to]) - p;
        const Vec3 q = target.vertices[g.from], other = target.vertices[g.to] - q;
        const Vec3 x = cross(along, other);
        const double whole = dot(x, x), sine = std::sqrt(whole) / (length(along) * length(other));
        if (sine < 1e-3) return; // vertices see what is parallel
        const double s = dot(cross(q - p, other), x) / whole, u = dot(cross(q - p, along), x) / whole;
        const double within = std::min({s, 1 - s, u, 1 - u});
        if (within < 0) return;
        Vec3 n = unit((p + s * along) - (q + u * other));
        const double gap = length((p + s * along) - (q + u * other));
        if (gap > margin_ + tiny_ || gap < 10 * tiny_) return;
        const double by = std::max(leaves_arc(source, e, -n, along, true), leaves_arc(target, g, n, other, false));
        if (by > tolerance_) return;
        const bool sure = by < -1e-4 && gap < margin_ - tiny_ && within > 1e-6 && sine > 2e-3 && hidden(e, g) > 1.001;
        found.push_back({true, e.number, g.number, n, gap, sure});
    }

    double leaves_arc(const Solid& solid, const Edge& e, const Vec3& n, const Vec3& along, bool turn) const {
        const auto normal = [&](int k) {
            const Vec3& own = solid.face_normals[e.faces[k]];
            return turn ? view_.turned(own) : own;
        };
        const double first = dot(n, cross(normal(0), unit(along)));
        return e.faces[1] == none ? std::max(first, -dot(n, normal(0)))
                                  : std::max(first, -dot(n, cross(normal(1), unit(along))));
    }

    const View& view_;
    double margin_, tolerance_, tiny_;
};

} // namespace raycontact::reference
