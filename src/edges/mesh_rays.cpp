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

const trees::Walks& walks() {
    static const trees::Walks& widest = *trees::usable_walks().front();
    return widest;
}

} // namespace

MeshHit closest_hit(const ShapeData& mesh, const Vec3& origin, const Vec3& direction, double least, double most) {
    return walks().closest_hit({mesh.nodes.data(), mesh.triangle_blocks.data()},
                               {{origin.x, origin.y, origin.z},
                                {direction.x, direction.y, direction.z},
                                least,
                                most,
                                mesh.header.tolerance,
                                mesh.reach});
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
