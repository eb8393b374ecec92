// SPDX-License-Identifier: Apache-2.0
#include "edges/mesh_rays.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace raycontact {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();
// Each level of the tree leaves at most fifteen children waiting.
constexpr std::size_t most_waiting = NODE_LEVELS * NODE_LANES;

// Along the ray; negative or `never`: it misses. Edges belong to the triangle.
double meets(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c,
             bool& from_inside) {
    const Vec3 p = a - origin, q = b - origin, r = c - origin;
    const double u = dot(cross(q, r), direction), v = dot(cross(r, p), direction), w = dot(cross(p, q), direction);
    from_inside = u >= 0 && v >= 0 && w >= 0;
    if (!from_inside && !(u <= 0 && v <= 0 && w <= 0)) return never;
    const double volume = u + v + w;
    if (volume == 0) return never;
    return (u * dot(p, direction) + v * dot(q, direction) + w * dot(r, direction)) / volume;
}

// A bit for each child whose box the ray meets within `most`. In float: the boxes are grown by far more than that.
std::uint32_t children_on_ray(const kernels::Node& node, const std::array<float, 3>& o,
                              const std::array<float, 3>& inverse, float most) {
    std::array<float, NODE_LANES> enter{}, leave{};
    for (int k = 0; k < NODE_LANES; ++k) leave[static_cast<std::size_t>(k)] = most;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float at = o[axis], by = inverse[axis];
        const auto& low = node.bounds[axis];
        const auto& high = node.bounds[3 + axis];
        for (std::size_t k = 0; k < NODE_LANES; ++k) {
            const float t0 = (low[k] - at) * by, t1 = (high[k] - at) * by;
            const float first = t0 < t1 ? t0 : t1, last = t0 < t1 ? t1 : t0;
            enter[k] = first > enter[k] ? first : enter[k];
            leave[k] = last < leave[k] ? last : leave[k];
        }
    }
    std::uint32_t found = 0;
    for (std::size_t k = 0; k < NODE_LANES; ++k)
        found |= static_cast<std::uint32_t>(enter[k] <= leave[k] && node.child[k] != NONE) << k;
    return found;
}

} // namespace

MeshHit closest_hit(const ShapeData& mesh, const Vec3& origin, const Vec3& direction, double least, double most) {
    const std::array<float, 3> from{static_cast<float>(origin.x), static_cast<float>(origin.y),
                                    static_cast<float>(origin.z)};
    std::array<float, 3> inverse{};
    for (std::size_t k = 0; k < 3; ++k) {
        const double d = axis(direction, k);
        inverse[k] = static_cast<float>(1 / (std::fabs(d) > 1e-20 ? d : 1e-20));
    }
    MeshHit hit;
    std::array<std::uint32_t, most_waiting> waiting;
    std::size_t count = 0;
    waiting[count++] = 0;
    while (count > 0) {
        const kernels::Node& node = mesh.nodes[waiting[--count]];
        const double limit = std::min(most, hit.distance) + mesh.header.tolerance;
        const float reach = limit < 3e38 ? static_cast<float>(1.000001 * limit) : 3e38f;
        for (std::uint32_t found = children_on_ray(node, from, inverse, reach); found != 0; found &= found - 1) {
            const std::uint32_t child = node.child[__builtin_ctz(found)];
            if ((child & LEAF) == 0) {
                waiting[count++] = child;
                continue;
            }
            for (const std::uint32_t t : mesh.triangle_blocks[child & ~LEAF].triangle) {
                if (t == NONE) continue;
                bool from_inside = false;
                const double at =
                    meets(origin, direction, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2), from_inside);
                if (at > least && at <= most && (at < hit.distance || (at == hit.distance && t < hit.face)))
                    hit = {at, t, from_inside};
            }
        }
    }
    return hit;
}

Vec3 nearest_point(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = cross(b - a, c - a);
    const double size2 = dot(n, n);
    if (size2 > 0 && dot(n, cross(b - a, p - a)) >= 0 && dot(n, cross(c - b, p - b)) >= 0
        && dot(n, cross(a - c, p - c)) >= 0)
        return p - (dot(n, p - a) / size2) * n;
    Vec3 best = a;
    double least = never;
    const std::array corners{a, b, c};
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 from = corners[k], along = corners[(k + 1) % 3] - from;
        const double length2 = dot(along, along);
        const double part = length2 > 0 ? std::clamp(dot(p - from, along) / length2, 0.0, 1.0) : 0;
        const Vec3 point = from + part * along, off = p - point;
        if (dot(off, off) < least) {
            least = dot(off, off);
            best = point;
        }
    }
    return best;
}

NearestFace nearest_face(const ShapeData& mesh, const Vec3& point, double enough) {
    NearestFace found;
    double least2 = never;
    std::array<std::pair<double, std::uint32_t>, most_waiting> waiting;
    std::size_t count = 0;
    waiting[count++] = {0, 0};
    while (count > 0) {
        const auto [away, index] = waiting[--count];
        if (away >= least2) continue;
        const kernels::Node& node = mesh.nodes[index];
        const std::size_t before = count;
        for (std::size_t k = 0; k < NODE_LANES; ++k) {
            const std::uint32_t child = node.child[k];
            if (child == NONE) continue;
            double off2 = 0;
            for (std::size_t i = 0; i < 3; ++i) {
                const double p = axis(point, i);
                const double off = std::max({double(node.bounds[i][k]) - p, p - double(node.bounds[3 + i][k]), 0.0});
                off2 += off * off;
            }
            if (off2 >= least2) continue;
            if ((child & LEAF) == 0) {
                waiting[count++] = {off2, child};
                continue;
            }
            for (const std::uint32_t t : mesh.triangle_blocks[child & ~LEAF].triangle) {
                if (t == NONE) continue;
                const Vec3 off = point - nearest_point(point, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
                const double distance2 = dot(off, off);
                if (distance2 < least2 || (distance2 == least2 && t < found.face)) {
                    least2 = distance2;
                    found = {std::sqrt(distance2), t};
                }
            }
            if (found.distance <= enough) return found;
        }
        // The nearest box last, so that it is next.
        std::sort(waiting.begin() + static_cast<std::ptrdiff_t>(before),
                  waiting.begin() + static_cast<std::ptrdiff_t>(count),
                  [](const auto& p, const auto& q) { return p > q; });
    }
    return found;
}

} // namespace raycontact
