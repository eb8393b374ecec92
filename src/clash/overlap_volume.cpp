// SPDX-License-Identifier: Apache-2.0
// A body is what lies below its faces that look up, less what lies below those that look down: so the volume of what
// two bodies share is a sum over the pairs of their faces, of the volume below both. Below two faces lies a prism over
// the polygon in which their shadows overlap; on it the lower height is linear, but for one straight fold.
#include <raycontact/clash.h>

#include "interruption.h"
#include "mesh/measure.h"
#include "query/checks.h"
#include "query/shadow.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace raycontact {

namespace {

struct Placed {
    std::vector<Vec3> vertices;
    Box box;
};

/// Relative to `origin`, so that far away nothing is lost.
Placed place(const Shape& shape, const Pose& pose, const Vec3& origin) {
    Placed placed;
    for (const Vec3& v : shape.file_vertices())
        placed.vertices.push_back(rotated(pose.rotation, v) + (pose.translation - origin));
    placed.box = box_of(placed.vertices);
    return placed;
}

/// The integral of a height that is linear over the polygon.
template <class Height>
double volume_below(const ShadowPolygon& polygon, Height height) {
    double sum = 0;
    for (std::size_t k = 2; k < polygon.count; ++k) {
        const ShadowCorner &p = polygon.corners[0], &q = polygon.corners[k - 1], &r = polygon.corners[k];
        sum += doubled_area(p, q, r) * (height(p) + height(q) + height(r)) / 6;
    }
    return sum;
}

/// The faces that can count: above the floor of `room`, and their shadow over it. `up` is 0, 1 or 2.
std::vector<ShadowFace> faces_of(const Shape& shape, const Placed& placed, const Box& room, std::size_t up) {
    const std::size_t x = (up + 1) % 3, y = (up + 2) % 3; // in a circle: what looks up still does
    std::vector<ShadowFace> faces;
    for (const auto& triangle : shape.triangles()) {
        std::array<ShadowCorner, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& v = placed.vertices[triangle[k]];
            corners[k] = {axis(v, x), axis(v, y), axis(v, up) - axis(room.low, up), 0};
        }
        const ShadowFace face(corners);
        if (face.area == 0) continue; // upright: no shadow
        if (face.high > 0 && face.high_x > axis(room.low, x) && face.low_x < axis(room.high, x)
            && face.high_y > axis(room.low, y) && face.low_y < axis(room.high, y))
            faces.push_back(face);
    }
    return faces;
}

/// Of what lies above the floor and below both faces.
double volume_below_both(const ShadowFace& f, const ShadowFace& g) {
    ShadowPolygon shared = shared_shadow(f, g);
    shared = clipped(shared, [](const ShadowCorner& c) { return c.first; });
    shared = clipped(shared, [](const ShadowCorner& c) { return c.second; });
    double higher = 0;
    for (std::size_t k = 0; k < shared.count; ++k) higher += shared.corners[k].first - shared.corners[k].second;
    // Below the lower one, less where that is above the other. Of faces that coincide rounding alone says where that
    // is; but it is by rounding alone, too, and so is what it takes away.
    const double sign = higher > 0 ? -1 : 1;
    const auto above = [&](const ShadowCorner& c) { return sign * (c.first - c.second); };
    return volume_below(shared, [&](const ShadowCorner& c) { return higher > 0 ? c.second : c.first; })
           - volume_below(clipped(shared, above), above);
}

} // namespace

double overlap_volume(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    check_placed(pose_a, "pose of the first mesh");
    check_placed(pose_b, "pose of the second mesh");
    check_is_mesh(a, "the first mesh");
    check_is_mesh(b, "the second mesh");
    const Placed in_a = place(a, pose_a, pose_a.translation), in_b = place(b, pose_b, pose_a.translation);
    const Box room{most(in_a.box.low, in_b.box.low), least(in_a.box.high, in_b.box.high)};
    const Vec3 size = room.high - room.low;
    if (!(size.x > 0 && size.y > 0 && size.z > 0)) return 0;
    // The longest side up: the fewest shadows.
    const std::size_t up = size.z >= size.x && size.z >= size.y ? 2 : size.y >= size.x ? 1 : 0;
    const std::vector<ShadowFace> first = faces_of(a, in_a, room, up);
    std::vector<ShadowFace> second = faces_of(b, in_b, room, up);
    std::sort(second.begin(), second.end(), [](const ShadowFace& f, const ShadowFace& g) { return f.low_x < g.low_x; });
    double widest = 0, sum = 0;
    for (const ShadowFace& g : second) widest = std::max(widest, g.high_x - g.low_x);
    const InterruptionCheck check;
    for (const ShadowFace& f : first) {
        check();
        for (auto at = std::ranges::lower_bound(second, f.low_x - widest, {}, &ShadowFace::low_x); at != second.end();
             ++at) {
            const ShadowFace& g = *at;
            if (g.low_x >= f.high_x) break;
            if (f.is_beside(g)) continue;
            sum += f.sign * g.sign * volume_below_both(f, g);
        }
    }
    return std::max(sum, 0.0);
}

} // namespace raycontact
