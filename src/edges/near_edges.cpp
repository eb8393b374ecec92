// SPDX-License-Identifier: Apache-2.0
#include "edges/near_edges.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

namespace raycontact {

namespace {

/// A face of the target, seen along the directions that may part it from an edge.
struct Face {
    std::array<Vec3, 3> corners;
    Vec3 normal;

    Face(const ShapeData& target, std::uint32_t face)
        : corners{target.corner(face, 0), target.corner(face, 1), target.corner(face, 2)},
          normal(unit(cross(corners[1] - corners[0], corners[2] - corners[0]))) {}

    bool is_near(const Vec3& p, const Vec3& q, double margin) const {
        if (parts(normal, p, q, margin)) return false;
        for (std::size_t k = 0; k < 3; ++k)
            if (parts(unit(cross(corners[(k + 1) % 3] - corners[k], normal)), p, q, margin)) return false;
        return true;
    }

private:
    static Vec3 unit(const Vec3& v) {
        const double size = length(v);
        return size > 0 ? (1 / size) * v : Vec3{};
    }
    // Asks all corners, since the normal of a sliver may point anywhere.
    bool parts(const Vec3& along, const Vec3& p, const Vec3& q, double margin) const {
        const double s = dot(p, along), t = dot(q, along);
        const double a = dot(corners[0], along), b = dot(corners[1], along), c = dot(corners[2], along);
        return std::min(s, t) > std::max({a, b, c}) + margin || std::max(s, t) < std::min({a, b, c}) - margin;
    }
};

// near: pairs of triangles, those of one triangle of either body mostly in a row.
void add(const SourceMesh& placed, std::span<const TrianglePair> near, bool source_first, double margin,
         std::vector<NearEdge>& found) {
    const ShapeData& source = placed.source;
    const auto begin = static_cast<std::ptrdiff_t>(found.size());
    std::uint32_t own = NONE, other = NONE;
    unsigned asked = 0; // a bit for each edge of own
    std::array<Vec3, 3> corners;
    std::optional<Face> face;
    for (const TrianglePair& pair : near) {
        const std::uint32_t next = source_first ? pair.first : pair.second;
        if (next != own) {
            own = next;
            asked = 0;
            for (std::size_t k = 0; k < 3; ++k)
                if (const std::uint32_t across = source.neighbours[own][k]; across == NONE || across > own)
                    asked |= 1u << k;
            for (std::size_t k = 0; k < 3 && asked != 0; ++k) corners[k] = placed.vertex(source.mesh.triangles[own][k]);
        }
        if (asked == 0) continue;
        const std::uint32_t target = source_first ? pair.second : pair.first;
        if (target != other) face.emplace(placed.target, other = target);
        for (std::uint32_t k = 0; k < 3; ++k)
            if ((asked >> k & 1u) != 0 && face->is_near(corners[k], corners[(k + 1) % 3], margin))
                found.push_back({3 * own + k, other});
    }
    std::sort(found.begin() + begin, found.end(),
              [](const NearEdge& p, const NearEdge& q) { return std::tie(p.edge, p.face) < std::tie(q.edge, q.face); });
}

} // namespace

double mismatch(const std::array<SourceMesh, 2>& placed) {
    const Pose &there = placed[0].pose, &back = placed[1].pose;
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            double product = i == j ? -1 : 0;
            for (std::size_t k = 0; k < 3; ++k) product += back.rotation[3 * i + k] * there.rotation[3 * k + j];
            sum += product * product;
        }
    return std::sqrt(sum) * placed[0].source.reach + length(placed[1].placed(there.translation));
}

std::size_t NearSearch::find(const std::array<SourceMesh, 2>& placed, double margin, std::vector<NearEdge>& found) {
    margin += 2 * mismatch(placed); // b near a is asked by its own direction
    triangles_.clear();
    find_near_triangles(placed[0], margin, triangles_);
    // More than what double rounds.
    const double apart =
        margin + 3 * placed[0].hair
        + 1e-12 * (placed[0].source.reach + placed[0].target.reach + length(placed[0].pose.translation));
    std::size_t first = 0;
    for (std::size_t side = 0; side < 2; ++side) {
        const std::size_t before = found.size();
        add(placed[side], triangles_, side == 0, apart, found);
        if (side == 0) first = found.size() - before;
    }
    return first;
}

} // namespace raycontact
