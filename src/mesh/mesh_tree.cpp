// SPDX-License-Identifier: Apache-2.0
#include "mesh/mesh_tree.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace raycontact {

MeshTree::MeshTree(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                   std::span<const std::uint32_t> chosen, Executor& executor)
    : boxes_(triangles.size()) {
    const Box whole = raycontact::box_of(vertices);
    middle_ = whole.middle();
    std::vector<kernels::Packed3> points;
    points.reserve(vertices.size());
    for (const Vec3& v : vertices) {
        const Vec3 off = v - middle_;
        points.push_back({static_cast<float>(off.x), static_cast<float>(off.y), static_cast<float>(off.z)});
    }
    for (const std::uint32_t t : chosen) {
        const auto [a, b, c] = triangles[t];
        boxes_[t] = raycontact::box_of(std::array{vertices[a], vertices[b], vertices[c]});
    }
    // Of the differences in double; that of float32 the builder allows for.
    const double grow = 1e-15 * (length(whole.low) + length(whole.high));
    if (!build_tree(tree_, {points, triangles, chosen, grow, true, most_tree_levels}, executor))
        throw std::logic_error("a balanced tree is too deep");
}

Box MeshTree::box_of(const kernels::TriangleBlock& block) const {
    Box box = boxes_[block.triangle[0]];
    for (const std::uint32_t t : block.triangle)
        if (t != NONE) box.add(boxes_[t]);
    return box;
}

Vec3 MeshTree::without_zeros(Vec3 direction) {
    for (double* x : {&direction.x, &direction.y, &direction.z})
        if (*x == 0) *x = 1e-300;
    return direction;
}

bool MeshTree::meets(const Box& box, const Vec3& origin, const Vec3& direction, double longest) {
    double enter = 0, leave = longest;
    for (std::size_t k = 0; k < 3; ++k) {
        const double o = axis(origin, k), inverse = 1 / axis(direction, k);
        const double t1 = (axis(box.low, k) - o) * inverse, t2 = (axis(box.high, k) - o) * inverse;
        enter = std::max(enter, std::min(t1, t2));
        leave = std::min(leave, std::max(t1, t2));
    }
    // Wide enough for the rounding above; one box too many costs little.
    return enter <= leave + 1e-9 * std::fabs(leave);
}

} // namespace raycontact
