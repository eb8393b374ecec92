// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace raycontact {

// How the blocks and nodes of a tree are written, by what builds it and by what restores it.

struct ItemBox {
    static constexpr float infinite = std::numeric_limits<float>::infinity();
    std::array<float, 3> low{infinite, infinite, infinite}, high{-infinite, -infinite, -infinite};

    void add(const ItemBox& other) {
        for (int i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], other.low[i]);
            high[i] = std::max(high[i], other.high[i]);
        }
    }
    double area() const {
        const double x = double(high[0]) - double(low[0]), y = double(high[1]) - double(low[1]),
                     z = double(high[2]) - double(low[2]);
        return x * y + y * z + z * x;
    }
};

inline ItemBox box_of_triangle(const TreePlan& plan, std::uint32_t triangle) {
    ItemBox box;
    for (const std::uint32_t v : plan.triangles[triangle]) {
        const auto [x, y, z] = plan.points[v];
        box.add({{x, y, z}, {x, y, z}});
    }
    return box;
}

/// Empty lanes (NONE) hold NaN.
inline void write_lane(kernels::TriangleBlock& block, std::size_t lane, const TreePlan& plan, std::uint32_t triangle) {
    block.triangle[lane] = triangle;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        constexpr float nan = std::numeric_limits<float>::quiet_NaN();
        const kernels::Packed3 p =
            triangle == NONE ? kernels::Packed3{nan, nan, nan} : plan.points[plan.triangles[triangle][corner]];
        block.corner[3 * corner + 0][lane] = p.x;
        block.corner[3 * corner + 1][lane] = p.y;
        block.corner[3 * corner + 2][lane] = p.z;
    }
}

/// box: null of an empty lane, which is inverted so far that no ray enters before it leaves.
inline void write_box(kernels::Node& node, std::size_t lane, const ItemBox* box, double grow) {
    constexpr float huge = 1e30f;
    for (int axis = 0; axis < 3; ++axis) {
        node.bounds[axis][lane] =
            box == nullptr ? huge : std::nextafter(static_cast<float>(double(box->low[axis]) - grow), -1e38f);
        node.bounds[3 + axis][lane] =
            box == nullptr ? -huge : std::nextafter(static_cast<float>(double(box->high[axis]) + grow), 1e38f);
    }
}

} // namespace raycontact
