// SPDX-License-Identifier: Apache-2.0
#include "speculative/approach.h"

#include "shape/around.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace raycontact {

namespace {

// Faces whose normals' product is larger are flush.
constexpr double flush = 0.9999;
// So many flush faces are looked at for a step of the surface.
constexpr std::size_t most_flush = 64;

// A direction may leave a vertex's normal cone by this, of a length; and the vertex looks at the target at all.
constexpr double cone = 0.03, sideways = 1e-6;
// A vertex in the middle of a face or slope, up to rounding, does not speak: corners do.
constexpr double in_face = 2e-5;

// Of NearestPoint::edges: the corner of two, and the one edge.
std::uint32_t corner_of(std::uint32_t edges) {
    return edges == 3 ? 1 : edges == 6 ? 2 : 0;
}
std::uint32_t edge_of(std::uint32_t edges) {
    return edges == 1 ? 0 : edges == 2 ? 1 : 2;
}

// The outward direction at a point of a face's border: of an edge the mean of its faces, of a corner its normal.
Vec3 border_normal(const ShapeData& mesh, std::uint32_t face, std::uint32_t edges) {
    if ((edges & (edges - 1)) != 0) return mesh.vertex_normals[mesh.mesh.triangles[face][corner_of(edges)]];
    const std::uint32_t across = mesh.neighbours[face][edge_of(edges)];
    const Vec3 own = unit(area_normal(mesh, face));
    return across == NONE ? own : own + unit(area_normal(mesh, across));
}

} // namespace

Approaches::Approaches(const SpeculativePair& pair, Side side, std::uint32_t vertex, std::span<const NearEdge> faces)
    : body_(pair.bodies[static_cast<std::size_t>(side)]), target_(body_.target), vertex_(vertex),
      faces_(faces), way_{transform_point(body_.now, body_.source.point(vertex)),
                          transform_point(body_.next, body_.source.point(vertex))},
      from_(way_[0]), to_(way_[1]), margin_(pair.margin), reach_(pair.margin), perturbation_(pair.perturbation) {
    // Deeper in than its own body is thick its ray tells nothing.
    if (double(body_.source.exit_distances[vertex]) < body_.thrown) reach_ = std::max(margin_, body_.thrown);
}

void Approaches::leave(const Vec3& normal, double depth) {
    const double out = depth + 2 * perturbation_;
    from_ = way_[0] + out * normal;
    to_ = way_[1] + std::max(0.0, out - dot(normal, way_[1] - way_[0])) * normal;
}

bool Approaches::reaches_farthest(const Approach& approach) const {
    const ShapeData& source = body_.source;
    const Vec3 p = source.point(vertex_), now = rotated_back(body_.now.rotation, approach.normal);
    const Vec3 back =
        approach.when > 0 ? part_of_turn(now, rotated_back(body_.next.rotation, approach.normal), approach.when) : now;
    if (!(dot(source.vertex_normals[vertex_], back) < -sideways)) return false;
    double behind = 0, beyond = 0; // of their distances
    any_neighbour(source, vertex_, [&](std::uint32_t w) {
        const Vec3 off = source.point(w) - p;
        const double back_by = dot(off, back) / length(off);
        behind = std::max(behind, back_by);
        beyond = std::max(beyond, -back_by);
        return beyond > cone;
    });
    return beyond <= cone && behind > 2 * beyond + in_face;
}

std::optional<Approach> Approaches::first_met() const {
    const Vec3 way = to_ - from_;
    const double size = length(way);
    if (!(size > perturbation_)) return std::nullopt;
    const Box passed = box_of(from_, to_, perturbation_);
    double first = 1;
    std::uint32_t face = NONE;
    for (const NearEdge& near : faces_) {
        const Vec3 a = target_.corner(near.face, 0), b = target_.corner(near.face, 1), c = target_.corner(near.face, 2);
        if (!Box{least(a, least(b, c)), most(a, most(b, c))}.touches(passed)) continue;
        const Vec3 p = a - from_, q = b - from_, r = c - from_;
        const double u = dot(cross(q, r), way), v = dot(cross(r, p), way), w = dot(cross(p, q), way);
        if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))) continue;
        const double volume = u + v + w;
        if (volume == 0) continue;
        const double at = (u * dot(p, way) + v * dot(q, way) + w * dot(r, way)) / (volume * size * size);
        if (at < -perturbation_ / size || at > first || (at == first && near.face > face)) continue;
        if (!is_listed(from_ + at * way)) continue;
        first = at;
        face = near.face;
    }
    if (face == NONE) return std::nullopt;
    const Vec3 out = unit(area_normal(target_, face)), corner = target_.corner(face, 0);
    if (!(dot(way, out) < 0)) return std::nullopt;
    return stopped({face, out, dot(from_ - corner, out), std::max(0.0, first)}, from_ + first * way);
}

// Whether every list of faces has what lies at a point.
bool Approaches::is_listed(const Vec3& point) const {
    if (from_ == way_[0] && to_ == way_[1]) return true;
    const Vec3& end = way_[body_.moves ? 1 : 0];
    return length(point - nearest_of(point, way_[0], end, end).point) <= reach_;
}

// Of the places around: an edge is one with both its faces, a corner with all that it shares an edge with.
bool Approaches::is_nearest(std::uint32_t face, const NearestPoint& point) const {
    if (point.edges == 0) return true;
    const Vec3 off = from_ - point.point;
    const auto is_behind = [&](std::uint32_t v) {
        const Vec3 there = target_.point(v) - point.point;
        return dot(there, off) <= 1e-6 * length(there) * length(off);
    };
    if ((point.edges & (point.edges - 1)) != 0)
        return !any_neighbour(target_, target_.mesh.triangles[face][corner_of(point.edges)],
                              [&](std::uint32_t v) { return !is_behind(v); });
    const std::uint32_t across = target_.neighbours[face][edge_of(point.edges)];
    return across == NONE || std::ranges::all_of(target_.mesh.triangles[across], is_behind);
}

void Approaches::add_near(std::vector<Approach>& found) const {
    const std::size_t first = found.size();
    const Box within = box_of(from_, from_, reach_);
    const Vec3 way = to_ - from_;
    for (const NearEdge& near : faces_) {
        const std::uint32_t face = near.face;
        const Vec3 a = target_.corner(face, 0), b = target_.corner(face, 1), c = target_.corner(face, 2);
        if (!Box{least(a, least(b, c)), most(a, most(b, c))}.touches(within)) continue;
        // A direction in the cone of an edge or corner is in front of one of its faces.
        const Vec3 area = cross(b - a, c - a);
        const double height = dot(from_ - a, area), reach = height < 0 ? perturbation_ : reach_;
        if (height * height > reach * reach * dot(area, area)) continue;
        const NearestPoint point = nearest_of(from_, a, b, c);
        const Vec3 off = from_ - point.point;
        const double gap = length(off);
        if (gap > reach_ || !is_listed(point.point) || !is_nearest(face, point)) continue;
        const bool is_border = point.edges != 0 && gap > perturbation_;
        if (is_border && !(dot(off, border_normal(target_, face, point.edges)) > 0)) continue;
        const Vec3 normal = is_border ? (1 / gap) * off : unit(area);
        // Beyond the margin it stops what is thrown there, but nothing that goes on.
        if (gap > margin_ && (passed_by(normal, gap, way) > 0 || gap + dot(normal, way) > body_.thrown)) continue;
        found.push_back(stopped({face, normal, gap}, point.point));
    }
    std::ranges::sort(found.begin() + static_cast<std::ptrdiff_t>(first), found.end(), {},
                      [](const Approach& one) { return std::pair(one.gap, one.face); });
}

// Of the faces beyond a convex edge of the flush ones, those count that the vertex is above, or below by no more than
// the margin. So a step of the surface that is lower is no wall. What stands for a contact is one.
Approach Approaches::least_change(const Approach& stops, const Vec3& at) const {
    const Vec3 way = to_ - from_;
    double passed = passed_by(stops.normal, stops.gap, way);
    if (!(passed > 0)) return stops;
    const bool is_contact = reaches_farthest(stops);
    Approach best = stops;
    std::array<std::uint32_t, most_flush> flat{stops.face};
    std::size_t count = 1;
    const Vec3 own = unit(area_normal(target_, stops.face));
    for (std::size_t i = 0; i < count; ++i)
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t across = target_.neighbours[flat[i]][k];
            if (across == NONE) continue;
            const Vec3 a = target_.corner(flat[i], k), b = target_.corner(flat[i], (k + 1) % 3);
            const double away = length(at - nearest_of(at, a, b, b).point);
            if (away > margin_ + glancing * passed) continue;
            const Vec3 n = unit(area_normal(target_, across));
            if (dot(n, own) > flush) {
                const auto end = flat.begin() + static_cast<std::ptrdiff_t>(count);
                if (count < most_flush && std::find(flat.begin(), end, across) == end) flat[count++] = across;
                continue;
            }
            const auto is_above = [&](std::uint32_t v) { return dot(target_.point(v) - a, own) > perturbation_; };
            if (std::ranges::any_of(target_.mesh.triangles[across], is_above)) continue; // it averts nothing
            const double gap = dot(from_ - target_.corner(across, 0), n), past = passed_by(n, gap, way);
            const bool is_beside = away <= margin_ || (past < glancing * passed && away <= margin_ + past);
            const Approach other{across, n, gap, stops.when};
            if (past < passed && gap > -margin_ && is_beside && (!is_contact || reaches_farthest(other))) {
                passed = past;
                best = other;
            }
        }
    return best;
}

Approach Approaches::stopped(const Approach& stops, const Vec3& at) const {
    Approach best = least_change(stops, at);
    best.gap = std::max(0.0, best.gap);
    return best;
}

} // namespace raycontact
