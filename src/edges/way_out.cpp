// SPDX-License-Identifier: Apache-2.0
#include "edges/way_out.h"

#include <algorithm>
#include <cmath>

namespace raycontact {

namespace {

// A contact's normal may leave the arc between the normals of an edge's faces by this, radians.
constexpr double arc = 0.1;
// A ray from a piece begins this part of its half inside.
constexpr double pull = 1e-3;
// A face along an edge, which perturbations alone cross, leans at least so much: sine.
constexpr double least_lean = 1e-9;
// Two planes that meet farther away than so many lengths of the piece are parallel.
constexpr double farthest = 1e3;
constexpr double never = std::numeric_limits<double>::infinity();

std::array<Vec3, 2> normals_at(const PairMeshes& pair, const EdgePiece& piece) {
    const auto [own, across] = faces_of(pair.shape(piece.side), piece.edge);
    const Vec3 n = pair.normal(piece.side, own);
    return {n, across == NONE ? n : pair.normal(piece.side, across)};
}

bool is_in_arc(const Vec3& direction, const std::array<Vec3, 2>& normals) {
    const Vec3 middle = unit(normals[0] + normals[1]);
    const auto angle = [&](const Vec3& v) { return std::acos(std::clamp(dot(v, middle), -1.0, 1.0)); };
    return angle(direction) - angle(normals[0]) < arc;
}

} // namespace

WayOut way_over_ridge(const PairMeshes& pair, const EdgePiece& piece, std::span<const Crossing> crossings) {
    const std::size_t other = 1 - piece.side;
    const std::uint32_t entry = crossings[piece.crossings[0]].face, exit = crossings[piece.crossings[1]].face;
    const Vec3 whole = piece.ends[1] - piece.ends[0], along = unit(whole);
    const Vec3 in = pair.normal(other, entry), out = pair.normal(other, exit);
    const double enters = std::max(least_lean, -dot(in, along)), leaves = std::max(least_lean, dot(out, along));
    // Moved by w, the piece between the two planes is shorter by w . (in / enters + out / leaves).
    const Vec3 sum = leaves * in + enters * out;
    const double size = length(sum);
    if (!(size > enters * leaves / farthest)) return {};
    const Vec3 normal = (1 / size) * sum;
    const double depth = length(whole) * enters * leaves / size;
    const double foot = depth * dot(in, normal) / enters;
    return {depth,
            depth,
            normal,
            dot(in, normal) > dot(out, normal) ? entry : exit,
            piece.ends[0] + std::clamp(foot, 0.0, length(whole)) * along,
            is_in_arc(-1.0 * normal, normals_at(pair, piece))};
}

WayOut way_past_face(const PairMeshes& pair, const EdgePiece& piece, std::uint32_t face) {
    const std::size_t other = 1 - piece.side;
    const Vec3 normal = pair.normal(other, face), &vertex = piece.ends[piece.vertex_end()];
    const double depth = dot(pair.corner(other, face, 0) - vertex, normal);
    return {depth, depth, normal, face, vertex};
}

WayOut way_of_vertex(const PairMeshes& pair, const EdgePiece& piece) {
    const std::size_t other = 1 - piece.side;
    const ShapeData& shape = pair.shape(piece.side);
    const std::uint32_t vertex = ends_of(shape, piece.edge)[piece.vertex_end()];
    const Vec3 &from = piece.ends[piece.vertex_end()],
               way = pair.direction_in(other, pair.direction_from(piece.side, -1.0 * shape.vertex_normals[vertex]));
    const MeshHit hit =
        closest_hit(pair.shape(other), {pair.point_in(other, from), way, 0, double(shape.exit_distances[vertex])});
    if (hit.face == NONE || !hit.from_inside) return {};
    const double facing = dot(unit(area_normal(pair.shape(other), hit.face)), way);
    return {hit.distance, hit.distance * facing, pair.normal(other, hit.face), hit.face, from};
}

WayOut way_along(const PairMeshes& pair, const EdgePiece& piece, const Vec3& point, const Vec3& direction) {
    const MeshHit hit = exit_along(pair, piece, point, direction);
    if (hit.face == NONE) return {};
    const Vec3 normal = pair.normal(1 - piece.side, hit.face);
    return {hit.distance, hit.distance * dot(normal, direction), normal, hit.face, point};
}

Vec3 inward_of(const PairMeshes& pair, const EdgePiece& piece) {
    const auto normals = normals_at(pair, piece);
    return unit(-1.0 * (normals[0] + normals[1]));
}

MeshHit exit_along(const PairMeshes& pair, const EdgePiece& piece, const Vec3& point, const Vec3& way) {
    const std::size_t other = 1 - piece.side;
    const Vec3 from = point + pull * (piece.middle() - point);
    const MeshHit hit =
        closest_hit(pair.shape(other), {pair.point_in(other, from), pair.direction_in(other, way), 0, never});
    return hit.face != NONE && hit.from_inside ? hit : MeshHit{0, NONE, false};
}

} // namespace raycontact
