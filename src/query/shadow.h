// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace raycontact {

/// A corner of what two faces share as seen along a direction: its place across it, the height of either face there.
struct ShadowCorner {
    double x, y, first, second;
};

/// A convex polygon: a triangle, and a corner more for each line that clips it, of which there are six. Rounding may
/// have a thin one cross a line at every other corner.
struct ShadowPolygon {
    std::array<ShadowCorner, 32> corners;
    std::size_t count = 0;
    void add(const ShadowCorner& c) { corners[count++] = c; }
};

/// The part where `value`, linear over the polygon, is not negative.
template <class Value>
ShadowPolygon clipped(const ShadowPolygon& polygon, Value value) {
    ShadowPolygon kept;
    for (std::size_t k = 0; k < polygon.count; ++k) {
        const ShadowCorner &p = polygon.corners[k], &q = polygon.corners[k + 1 == polygon.count ? 0 : k + 1];
        const double at_p = value(p), at_q = value(q);
        if (at_p >= 0) kept.add(p);
        if ((at_p < 0) == (at_q < 0)) continue;
        const double s = at_p / (at_p - at_q);
        kept.add({p.x + s * (q.x - p.x), p.y + s * (q.y - p.y), p.first + s * (q.first - p.first),
                  p.second + s * (q.second - p.second)});
    }
    return kept;
}

inline double doubled_area(const ShadowCorner& p, const ShadowCorner& q, const ShadowCorner& r) {
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
}

/// A triangle as seen along a direction.
struct ShadowFace {
    std::array<ShadowCorner, 3> corners; ///< counter-clockwise; `first` is its height
    double area;                         ///< twice that of the shadow; 0: upright
    double sign;                         ///< 1: it looks up; -1: down
    double low_x, high_x, low_y, high_y, low, high;

    /// corners: counter-clockwise as seen from where the face looks.
    explicit ShadowFace(const std::array<ShadowCorner, 3>& seen)
        : corners(seen), area(doubled_area(seen[0], seen[1], seen[2])), sign(area > 0 ? 1 : -1) {
        if (area < 0) std::swap(corners[1], corners[2]);
        area = std::fabs(area);
        const auto& [a, b, c] = corners;
        low_x = std::min({a.x, b.x, c.x});
        high_x = std::max({a.x, b.x, c.x});
        low_y = std::min({a.y, b.y, c.y});
        high_y = std::max({a.y, b.y, c.y});
        low = std::min({a.first, b.first, c.first});
        high = std::max({a.first, b.first, c.first});
    }

    /// Within its heights: those of a nearly upright face would leave them by rounding.
    double height(const ShadowCorner& at) const {
        const auto& [a, b, c] = corners;
        const double sum =
            doubled_area(b, c, at) * a.first + doubled_area(c, a, at) * b.first + doubled_area(a, b, at) * c.first;
        return std::clamp(sum / area, low, high);
    }
    bool is_beside(const ShadowFace& other) const {
        return other.low_x >= high_x || other.high_x <= low_x || other.low_y >= high_y || other.high_y <= low_y;
    }
};

/// What the shadows of two faces share, with the heights of the first and the second. Neither is upright.
inline ShadowPolygon shared_shadow(const ShadowFace& first, const ShadowFace& second) {
    ShadowPolygon shared;
    for (const ShadowCorner& c : first.corners) shared.add(c);
    for (std::size_t k = 0; k < 3; ++k) {
        const ShadowCorner &p = second.corners[k], &q = second.corners[(k + 1) % 3];
        shared = clipped(shared, [&](const ShadowCorner& c) { return doubled_area(p, q, c); });
        if (shared.count < 3) return {};
    }
    for (std::size_t k = 0; k < shared.count; ++k) shared.corners[k].second = second.height(shared.corners[k]);
    return shared;
}

} // namespace raycontact
