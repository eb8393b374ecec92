// SPDX-License-Identifier: Apache-2.0
#include "query/winding.h"

#include "mesh/measure.h"
#include "mesh/predicates.h"
#include "shape/shape_data.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace raycontact {

namespace {

// 1: the segment leaves through the triangle's front, -1: it enters, 0: it passes by; nothing: it meets an edge or a
// corner, or lies in the plane, so another segment must be asked.
std::optional<int> crossing(const Vec3& from, const Vec3& to, const Vec3& a, const Vec3& b, const Vec3& c) {
    const int before = orient3d(a, b, c, from), after = orient3d(a, b, c, to);
    if (before == after && before != 0) return 0;
    const std::array sides{orient3d(from, to, a, b), orient3d(from, to, b, c), orient3d(from, to, c, a)};
    bool positive = false, negative = false, on_edge = false;
    for (const int side : sides) {
        positive = positive || side > 0;
        negative = negative || side < 0;
        on_edge = on_edge || side == 0;
    }
    if (positive && negative) return 0;
    if (on_edge || before == 0 || after == 0) return std::nullopt;
    return before > after ? 1 : -1;
}

bool meets(const Box& segment_box, const kernels::Node& node, int lane) {
    return segment_box.low.x <= double(node.bounds[3][lane]) && segment_box.high.x >= double(node.bounds[0][lane])
           && segment_box.low.y <= double(node.bounds[4][lane]) && segment_box.high.y >= double(node.bounds[1][lane])
           && segment_box.low.z <= double(node.bounds[5][lane]) && segment_box.high.z >= double(node.bounds[2][lane]);
}

// Along a segment that ends outside of the mesh's box.
std::optional<int> winding_along(const ShapeData& shape, const Vec3& from, const Vec3& to) {
    const Box box{least(from, to), most(from, to)};
    std::vector<std::uint32_t> open{0};
    int winding = 0;
    while (!open.empty()) {
        const kernels::Node& node = shape.nodes[open.back()];
        open.pop_back();
        for (int lane = 0; lane < NODE_LANES; ++lane) {
            const std::uint32_t child = node.child[lane];
            if (child == NONE || !meets(box, node, lane)) continue;
            if ((child & LEAF) == 0) {
                open.push_back(child);
                continue;
            }
            for (const std::uint32_t t : shape.triangle_blocks[child & ~LEAF].triangle) {
                if (t == NONE) continue;
                const auto signs = crossing(from, to, snapped(shape.corner(t, 0)), snapped(shape.corner(t, 1)),
                                            snapped(shape.corner(t, 2)));
                if (!signs) return std::nullopt;
                winding += *signs;
            }
        }
    }
    return winding;
}

} // namespace

int winding_number(const ShapeData& shape, const Vec3& point) {
    const Vec3 p = snapped(point);
    const Vec3 low{shape.header.low[0], shape.header.low[1], shape.header.low[2]};
    const Vec3 high{shape.header.high[0], shape.header.high[1], shape.header.high[2]};
    if (least(p, low) != low || most(p, high) != high) return 0;
    // Straight out through a face of the box, a little askew, so that a segment's box stays slim.
    std::uint32_t state = 1;
    const auto askew = [&] {
        state = state * 1664525u + 1013904223u;
        return 0.01 * (static_cast<double>(state >> 8) / 8388608.0 - 1);
    };
    constexpr int attempts = 64; // as many that all meet an edge: the point is on the surface
    for (int i = 0; i < attempts; ++i) {
        const double rise = high.x - p.x + 0.1 * shape.diagonal;
        const Vec3 to = snapped({p.x + rise, p.y + askew() * rise, p.z + askew() * rise});
        if (const auto winding = winding_along(shape, p, to)) return *winding;
    }
    return 1;
}

} // namespace raycontact
