// SPDX-License-Identifier: Apache-2.0
// A body is what lies below its faces that look up, less what lies below those that look down: so the volume of what
// two bodies share is a sum over the pairs of their faces, of the volume below both. Below two faces lies a prism over
// the polygon in which their shadows overlap; on it the lower height is linear, but for one straight fold.
#include <raycontact/clash.h>

#include "interruption.h"
#include "mesh/measure.h"
#include "query/checks.h"

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

/// x and y of the shadow, the height of either face above the floor.
struct Corner {
    double x, y, first, second;
};

/// A convex polygon: a triangle, and a corner more for each line that clips it, of which there are six. Rounding may
/// have a thin one cross a line at every other corner.
struct Polygon {
    std::array<Corner, 32> corners;
    std::size_t count = 0;
    void add(const Corner& c) { corners[count++] = c; }
};

/// The part where `value`, linear over the polygon, is not negative.
template <class Value>
Polygon clipped(const Polygon& polygon, Value value) {
    Polygon kept;
    for (std::size_t k = 0; k < polygon.count; ++k) {
        const Corner &p = polygon.corners[k], &q = polygon.corners[k + 1 == polygon.count ? 0 : k + 1];
        const double at_p = value(p), at_q = value(q);
        if (at_p >= 0) kept.add(p);
        if ((at_p < 0) == (at_q < 0)) continue;
        const double s = at_p / (at_p - at_q);
        kept.add({p.x + s * (q.x - p.x), p.y + s * (q.y - p.y), p.first + s * (q.first - p.first),
                  p.second + s * (q.second - p.second)});
    }
    return kept;
}

double doubled_area(const Corner& p, const Corner& q, const Corner& r) {
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
}

/// The integral of a height that is linear over the polygon.
template <class Height>
double volume_below(const Polygon& polygon, Height height) {
    double sum = 0;
    for (std::size_t k = 2; k < polygon.count; ++k) {
        const Corner &p = polygon.corners[0], &q = polygon.corners[k - 1], &r = polygon.corners[k];
        sum += doubled_area(p, q, r) * (height(p) + height(q) + height(r)) / 6;
    }
    return sum;
}

struct Face {
    std::array<Corner, 3> corners; ///< counter-clockwise; `first` is its height
    double area;                   ///< twice that of the shadow
    double sign;                   ///< 1: it looks up; -1: down
    double low_x, high_x, low_y, high_y, low, high;
};

/// The faces that can count: above the floor of `room`, and their shadow over it. `up` is 0, 1 or 2.
std::vector<Face> faces_of(const Shape& shape, const Placed& placed, const Box& room, std::size_t up) {
    const std::size_t x = (up + 1) % 3, y = (up + 2) % 3; // in a circle: what looks up still does
    std::vector<Face> faces;
    for (const auto& triangle : shape.triangles()) {
        Face face;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& v = placed.vertices[triangle[k]];
            face.corners[k] = {axis(v, x), axis(v, y), axis(v, up) - axis(room.low, up), 0};
        }
        face.area = doubled_area(face.corners[0], face.corners[1], face.corners[2]);
        if (face.area == 0) continue; // upright: no shadow
        face.sign = face.area > 0 ? 1 : -1;
        if (face.area < 0) std::swap(face.corners[1], face.corners[2]);
        face.area = std::fabs(face.area);
        const auto [a, b, c] = face.corners;
        face.low_x = std::min({a.x, b.x, c.x});
        face.high_x = std::max({a.x, b.x, c.x});
        face.low_y = std::min({a.y, b.y, c.y});
        face.high_y = std::max({a.y, b.y, c.y});
        face.low = std::min({a.first, b.first, c.first});
        face.high = std::max({a.first, b.first, c.first});
        if (face.high > 0 && face.high_x > axis(room.low, x) && face.low_x < axis(room.high, x)
            && face.high_y > axis(room.low, y) && face.low_y < axis(room.high, y))
            faces.push_back(face);
    }
    return faces;
}

/// Within its heights: those of a nearly upright face would leave them by rounding.
double height_of(const Face& face, const Corner& at) {
    const auto& [a, b, c] = face.corners;
    const double height =
        (doubled_area(b, c, at) * a.first + doubled_area(c, a, at) * b.first + doubled_area(a, b, at) * c.first)
        / face.area;
    return std::clamp(height, face.low, face.high);
}

/// Of what lies above the floor and below both faces.
double volume_below_both(const Face& f, const Face& g) {
    Polygon shared;
    for (const Corner& c : f.corners) shared.add(c);
    for (std::size_t k = 0; k < 3; ++k) {
        const Corner &p = g.corners[k], &q = g.corners[(k + 1) % 3];
        shared = clipped(shared, [&](const Corner& c) { return doubled_area(p, q, c); });
        if (shared.count < 3) return 0;
    }
    for (std::size_t k = 0; k < shared.count; ++k) shared.corners[k].second = height_of(g, shared.corners[k]);
    shared = clipped(shared, [](const Corner& c) { return c.first; });
    shared = clipped(shared, [](const Corner& c) { return c.second; });
    double higher = 0;
    for (std::size_t k = 0; k < shared.count; ++k) higher += shared.corners[k].first - shared.corners[k].second;
    // Below the lower one, less where that is above the other. Of faces that coincide rounding alone says where that
    // is; but it is by rounding alone, too, and so is what it takes away.
    const double sign = higher > 0 ? -1 : 1;
    const auto above = [&](const Corner& c) { return sign * (c.first - c.second); };
    return volume_below(shared, [&](const Corner& c) { return higher > 0 ? c.second : c.first; })
           - volume_below(clipped(shared, above), above);
}

} // namespace

double overlap_volume(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    check_placed(pose_a, "pose of the first mesh");
    check_placed(pose_b, "pose of the second mesh");
    const Placed in_a = place(a, pose_a, pose_a.translation), in_b = place(b, pose_b, pose_a.translation);
    const Box room{most(in_a.box.low, in_b.box.low), least(in_a.box.high, in_b.box.high)};
    const Vec3 size = room.high - room.low;
    if (!(size.x > 0 && size.y > 0 && size.z > 0)) return 0;
    // The longest side up: the fewest shadows.
    const std::size_t up = size.z >= size.x && size.z >= size.y ? 2 : size.y >= size.x ? 1 : 0;
    const std::vector<Face> first = faces_of(a, in_a, room, up);
    std::vector<Face> second = faces_of(b, in_b, room, up);
    std::sort(second.begin(), second.end(), [](const Face& f, const Face& g) { return f.low_x < g.low_x; });
    double widest = 0, sum = 0;
    for (const Face& g : second) widest = std::max(widest, g.high_x - g.low_x);
    const InterruptionCheck check;
    for (const Face& f : first) {
        check();
        for (auto at = std::ranges::lower_bound(second, f.low_x - widest, {}, &Face::low_x); at != second.end(); ++at) {
            const Face& g = *at;
            if (g.low_x >= f.high_x) break;
            if (g.high_x <= f.low_x || g.low_y >= f.high_y || g.high_y <= f.low_y) continue;
            sum += f.sign * g.sign * volume_below_both(f, g);
        }
    }
    return std::max(sum, 0.0);
}

} // namespace raycontact
