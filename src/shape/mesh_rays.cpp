// SPDX-License-Identifier: Apache-2.0
#include "shape/mesh_rays.h"

#include "mesh/descent.h"
#include "shape/around.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace raycontact {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

// Where the ray meets a triangle; otherwise `never`. Edges belong to it.
double meet(const kernels::TriangleBlock& block, std::size_t lane, const MeshRay& ray, bool& from_inside) {
    const auto corner = [&](std::size_t k) {
        return Vec3{block.corner[k][lane], block.corner[k + 1][lane], block.corner[k + 2][lane]} - ray.origin;
    };
    const Vec3 p = corner(0), q = corner(3), r = corner(6), &d = ray.direction;
    const double u = dot(cross(q, r), d), v = dot(cross(r, p), d), w = dot(cross(p, q), d);
    from_inside = u >= 0 && v >= 0 && w >= 0;
    if (!from_inside && !(u <= 0 && v <= 0 && w <= 0)) return never;
    const double volume = u + v + w;
    if (volume == 0) return never;
    const double at = (u * dot(p, d) + v * dot(q, d) + w * dot(r, d)) / volume;
    return at > ray.least && at <= ray.most ? at : never;
}

} // namespace

// With S, the farthest corner's distance from the mesh's centre and the origin's added, a volume in float is wrong by
// less than 2e-6 S^2; twice that serves.
FloatLine::FloatLine(const ShapeData& mesh, const Vec3& from, const Vec3& along, double slack) {
    double apart = mesh.reach;
    for (std::size_t k = 0; k < 3; ++k) {
        origin[k] = static_cast<float>(axis(from, k));
        direction[k] = static_cast<float>(axis(along, k));
        apart += std::fabs(axis(from, k));
    }
    error = static_cast<float>(4e-6 * apart * apart + 8 * slack * apart);
}

std::uint32_t triangles_on_line(const kernels::TriangleBlock& block, const FloatLine& line, std::uint32_t outside) {
    const auto [ox, oy, oz] = line.origin;
    const auto [dx, dy, dz] = line.direction;
    const float error = line.error;
    std::array<std::uint32_t, TRIANGLE_LANES> on;
    for (std::size_t k = 0; k < TRIANGLE_LANES; ++k) {
        const float px = block.corner[0][k] - ox, py = block.corner[1][k] - oy, pz = block.corner[2][k] - oz;
        const float qx = block.corner[3][k] - ox, qy = block.corner[4][k] - oy, qz = block.corner[5][k] - oz;
        const float rx = block.corner[6][k] - ox, ry = block.corner[7][k] - oy, rz = block.corner[8][k] - oz;
        const float u = (qy * rz - qz * ry) * dx + (qz * rx - qx * rz) * dy + (qx * ry - qy * rx) * dz;
        const float v = (ry * pz - rz * py) * dx + (rz * px - rx * pz) * dy + (rx * py - ry * px) * dz;
        const float w = (py * qz - pz * qy) * dx + (pz * qx - px * qz) * dy + (px * qy - py * qx) * dz;
        const std::uint32_t from_inside =
            std::uint32_t{u >= -error} & std::uint32_t{v >= -error} & std::uint32_t{w >= -error};
        const std::uint32_t from_outside =
            std::uint32_t{u <= error} & std::uint32_t{v <= error} & std::uint32_t{w <= error};
        on[k] = 0U - (from_inside | (from_outside & outside));
    }
    // Their bits as a table, which compilers load into lanes.
    constexpr std::array<std::uint32_t, TRIANGLE_LANES> bit{0x1,   0x2,   0x4,   0x8,   0x10,   0x20,   0x40,   0x80,
                                                            0x100, 0x200, 0x400, 0x800, 0x1000, 0x2000, 0x4000, 0x8000};
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < TRIANGLE_LANES; ++k) bits |= on[k] & bit[k];
    return bits;
}

// Boxes and lines are asked in float: boxes are grown by far more than its rounding.
MeshHit closest_hit(const ShapeData& mesh, const MeshRay& ray) {
    const FloatLine line(mesh, ray.origin, ray.direction);
    std::array<float, 3> inverse;
    for (std::size_t k = 0; k < 3; ++k) {
        const double d = axis(ray.direction, k);
        inverse[k] = static_cast<float>(1 / (std::fabs(d) > 1e-20 ? d : 1e-20));
    }
    const std::uint32_t outside = ray.from_inside ? 0 : 1;
    MeshHit hit;
    const auto farthest = [&] {
        const double limit = std::min(ray.most, hit.distance) + double(mesh.header.tolerance);
        return static_cast<float>(std::min(1.000001 * limit, 3e38));
    };
    const auto enter = [&](const kernels::Node& node, Lanes<float>& first) {
        constexpr float infinite = std::numeric_limits<float>::infinity();
        Lanes<float> last;
        first.fill(0);
        last.fill(infinite);
        for (std::size_t k = 0; k < 3; ++k) {
            const float at = line.origin[k], by = inverse[k];
            for (std::size_t lane = 0; lane < NODE_LANES; ++lane) {
                const float t0 = (node.bounds[k][lane] - at) * by, t1 = (node.bounds[3 + k][lane] - at) * by;
                first[lane] = std::max(first[lane], std::min(t0, t1));
                last[lane] = std::min(last[lane], std::max(t0, t1));
            }
        }
        for (std::size_t lane = 0; lane < NODE_LANES; ++lane)
            first[lane] = first[lane] <= last[lane] ? first[lane] : infinite;
    };
    nearest_first<float>(mesh, farthest, enter, [&](const kernels::TriangleBlock& block) {
        for (std::uint32_t on = triangles_on_line(block, line, outside); on != 0; on &= on - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(on));
            const std::uint32_t face = block.triangle[lane];
            bool from_inside;
            const double at = meet(block, lane, ray, from_inside);
            if (at == never || at > hit.distance || (at == hit.distance && face >= hit.face)) continue;
            if ((ray.from_inside && !from_inside) || std::ranges::find(ray.skipped, face) != ray.skipped.end())
                continue;
            hit = {at, face, from_inside};
        }
    });
    return hit;
}

NearestPoint nearest_of(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = cross(b - a, c - a);
    const double size2 = dot(n, n);
    if (size2 > 1e-12 * dot(b - a, b - a) * dot(c - a, c - a) && dot(n, cross(b - a, p - a)) >= 0
        && dot(n, cross(c - b, p - b)) >= 0 && dot(n, cross(a - c, p - c)) >= 0)
        return {p - (dot(n, p - a) / size2) * n, 0};
    NearestPoint best{a, 5};
    double least = never;
    const std::array corners{a, b, c};
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 from = corners[k], along = corners[(k + 1) % 3] - from;
        const double length2 = dot(along, along);
        const double part = length2 > 0 ? std::clamp(dot(p - from, along) / length2, 0.0, 1.0) : 0;
        const Vec3 point = from + part * along, off = p - point;
        if (dot(off, off) < least) {
            least = dot(off, off);
            const std::size_t beside = part > 0 ? k + 1 : k + 2; // the edge that it shares a corner with
            best = {point, 1u << k | (part > 0 && part < 1 ? 0u : 1u << (beside % 3))};
        }
    }
    return best;
}

namespace {

// The nearest of the faces that count, and no farther than `found`; the first within `enough`.
template <class Counts>
NearestFace nearest_of_faces(const ShapeData& mesh, const Vec3& point, double enough, NearestFace found,
                             Counts&& counts) {
    constexpr double rounding = 1 + 1e-12;
    double least2 = found.distance * found.distance;
    const auto farthest = [&] { return found.distance <= enough ? 0.0 : least2; };
    const auto away = [&](const kernels::Node& node, Lanes<double>& lanes) {
        for (std::size_t lane = 0; lane < NODE_LANES; ++lane) lanes[lane] = box_of(node, lane).squared_distance(point);
    };
    nearest_first<double>(mesh, farthest, away, [&](const kernels::TriangleBlock& block) {
        // How far the triangles' boxes are, side by side; NaN in empty lanes.
        Lanes<double> boxes2{};
        for (std::size_t k = 0; k < 3; ++k) {
            const double at = axis(point, k);
            const auto &p = block.corner[k], &q = block.corner[3 + k], &r = block.corner[6 + k];
            for (std::size_t lane = 0; lane < TRIANGLE_LANES; ++lane) {
                const double low = std::min(std::min(p[lane], q[lane]), r[lane]);
                const double high = std::max(std::max(p[lane], q[lane]), r[lane]);
                const double off = std::max(std::max(low - at, at - high), 0.0);
                boxes2[lane] += off * off;
            }
        }
        for (std::size_t lane = 0; lane < TRIANGLE_LANES; ++lane) {
            if (!(boxes2[lane] <= rounding * least2)) continue;
            const std::uint32_t face = block.triangle[lane];
            if (!counts(face)) continue;
            const Vec3 nearest = nearest_point(point, mesh.corner(face, 0), mesh.corner(face, 1), mesh.corner(face, 2));
            const Vec3 off = point - nearest;
            const double distance2 = dot(off, off);
            if (distance2 > least2 || (distance2 == least2 && face >= found.face)) continue;
            least2 = distance2;
            found = {std::sqrt(distance2), face};
        }
    });
    return found;
}

} // namespace

NearestFace nearest_face(const ShapeData& mesh, const Vec3& point, double enough, double bound) {
    const NearestFace found = nearest_of_faces(mesh, point, enough, {bound, NONE}, [](std::uint32_t) { return true; });
    return found.face == NONE ? NearestFace() : found;
}

NearestFace nearest_piece(const ShapeData& mesh, const Vec3& point, std::uint32_t file_triangle) {
    return nearest_of_faces(mesh, point, 0, {},
                            [&](std::uint32_t face) { return mesh.mesh.triangle_index[face] == file_triangle; });
}

NearestFace nearest_exit(const ShapeData& mesh, const ForeignVertex& own, const NearestFace& known) {
    // 3 degrees: a box that lies a little askew on another leaves by the top, not by a side near its corner.
    constexpr double against = 0.05;
    // What looks as the face that was hit is the same wall, which triangles may divide anyhow.
    constexpr double like = 0.98;
    const Vec3 hit = area_normal(mesh, known.face);
    const double least_like2 = like * like * dot(hit, hit);
    return nearest_of_faces(mesh, own.point, 0, known, [&](std::uint32_t face) {
        const Vec3 n = area_normal(mesh, face);
        if (dot(n, mesh.corner(face, 0) - own.point) < 0) return false;
        if (const double product = dot(n, hit); product > 0 && product * product > least_like2 * dot(n, n)) return true;
        const Vec3 turned = rotated_back(own.rotation, n);
        const double least = -against * length(n);
        return any_triangle_at(own.source, own.vertex, [&](std::uint32_t t, std::uint32_t) {
            const auto& m = own.source.face_normals[t];
            return double(m.x) * turned.x + double(m.y) * turned.y + double(m.z) * turned.z < least;
        });
    });
}

} // namespace raycontact
