// SPDX-License-Identifier: Apache-2.0
#include "mesh/descent.h"
#include "mesh/vector.h"
#include "shape/shape_data.h"

#include <raycontact/query.h>

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

namespace raycontact {

namespace {

Box in_body(const Box& about_centre, const Vec3& centre) {
    return {about_centre.low + centre, about_centre.high + centre};
}

Box box_of(const ShapeData& mesh, std::uint32_t triangle) {
    const Vec3 corners[] = {mesh.corner(triangle, 0), mesh.corner(triangle, 1), mesh.corner(triangle, 2)};
    return raycontact::box_of(corners);
}

} // namespace

void triangles_in_box(const Shape& shape, const Vec3& low, const Vec3& high, std::vector<std::uint32_t>& found) {
    found.clear();
    const ShapeData& mesh = shape.data();
    const Box asked{low - mesh.centre, high - mesh.centre};
    visit_blocks(
        mesh, [&](const Box& box) { return box.touches(asked); },
        [&](const kernels::TriangleBlock& block) {
            for (const std::uint32_t t : block.triangle)
                if (t != NONE && box_of(mesh, t).touches(asked)) found.push_back(t);
            return true;
        });
    std::ranges::sort(found);
}

void vertices_below(const Shape& shape, const Vec3& normal, double offset, std::vector<std::uint32_t>& found) {
    found.clear();
    const ShapeData& mesh = shape.data();
    const Vec3 size{std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)};
    // A little slack: boxes are only pruned; the vertices themselves decide.
    const double above = offset - dot(normal, mesh.centre),
                 slack = 1e-9 * (length(normal) * mesh.reach + std::fabs(above));
    visit_blocks(
        mesh,
        [&](const Box& box) {
            return dot(normal, box.middle()) - 0.5 * dot(size, box.high - box.low) <= above + slack;
        },
        [&](const kernels::TriangleBlock& block) {
            for (const std::uint32_t t : block.triangle) {
                if (t == NONE) continue;
                for (const std::uint32_t v : mesh.mesh.triangles[t])
                    if (dot(normal, mesh.mesh.vertices[v]) < offset) found.push_back(v);
            }
            return true;
        });
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
}

std::vector<AxisBox> covering_boxes(const Shape& shape, std::size_t most) {
    const ShapeData& mesh = shape.data();
    struct Open {
        double size;
        std::uint32_t child;
        Box box;
        bool operator<(const Open& other) const { return std::pair(size, child) < std::pair(other.size, other.child); }
    };
    const auto opened = [](std::uint32_t child, const Box& box) {
        return Open{(child & LEAF) != 0 ? -1 : dot(box.high - box.low, box.high - box.low), child, box};
    };
    std::priority_queue<Open> open; // the largest is opened next; leaves last
    open.push(opened(0, raycontact::box_of(mesh, Branch{0, NONE})));
    while (open.top().size >= 0 && open.size() + NODE_LANES - 1 <= most) {
        const kernels::Node& node = mesh.nodes[open.top().child];
        open.pop();
        for (std::size_t lane = 0; lane < NODE_LANES; ++lane)
            if (node.child[lane] != NONE) open.push(opened(node.child[lane], raycontact::box_of(node, lane)));
    }
    std::vector<AxisBox> boxes;
    for (; !open.empty(); open.pop()) {
        const Box box = in_body(open.top().box, mesh.centre);
        boxes.push_back({box.low, box.high});
    }
    return boxes;
}

} // namespace raycontact
