// SPDX-License-Identifier: Apache-2.0
#include "mesh/triangle_bvh.h"

#include "mesh/triangle_distance.h"

#include <algorithm>
#include <array>
#include <utility>

namespace raycontact {

TriangleBvh::TriangleBvh(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                         std::vector<std::uint32_t> chosen)
    : vertices_(vertices), triangles_(triangles), order_(std::move(chosen)) {
    nodes_.reserve(order_.size());
    build(0, static_cast<std::uint32_t>(order_.size()));
    boxes_.reserve(order_.size());
    for (const std::uint32_t triangle : order_) boxes_.push_back(triangle_box(triangle));
}

Box TriangleBvh::triangle_box(std::uint32_t triangle) const {
    const auto [a, b, c] = triangles_[triangle];
    return box_of(std::array{vertices_[a], vertices_[b], vertices_[c]});
}

std::uint32_t TriangleBvh::build(std::uint32_t first, std::uint32_t last) {
    Box box = triangle_box(order_[first]);
    for (std::uint32_t i = first + 1; i < last; ++i) box.add(triangle_box(order_[i]));
    const auto node = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({box, first, last, 0});
    if (last - first <= leaf_size) return node;

    const Vec3 size = box.high - box.low;
    const std::size_t k = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto key = [&](std::uint32_t triangle) {
        const Triangle& t = triangles_[triangle];
        return axis(vertices_[t[0]], k) + axis(vertices_[t[1]], k) + axis(vertices_[t[2]], k);
    };
    const std::uint32_t middle = first + (last - first) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                     [&](std::uint32_t a, std::uint32_t b) { return std::pair(key(a), a) < std::pair(key(b), b); });
    build(first, middle);
    const std::uint32_t right = build(middle, last);
    nodes_[node].right = right;
    return node;
}

double TriangleBvh::squared_distance_of(const Box& box, const Vec3& p) {
    const Vec3 off = most(most(box.low - p, p - box.high), Vec3{});
    return dot(off, off);
}

double TriangleBvh::nearest(const Vec3& point, double bound, std::uint32_t below) const {
    const Node& node = nodes_[below];
    for (std::uint32_t i = node.first; node.right == 0 && i < node.last; ++i) {
        if (squared_distance_of(boxes_[i], point) >= bound) continue;
        const auto [a, b, c] = triangles_[order_[i]];
        bound = std::min(bound, squared_distance(point, vertices_[a], vertices_[b], vertices_[c]));
    }
    if (node.right == 0) return bound;
    std::pair near{squared_distance_of(nodes_[below + 1].box, point), below + 1};
    std::pair far{squared_distance_of(nodes_[node.right].box, point), node.right};
    if (far.first < near.first) std::swap(near, far);
    for (const auto& [distance, child] : {near, far}) {
        if (distance < bound) bound = nearest(point, bound, child);
    }
    return bound;
}

bool TriangleBvh::meets(const Box& box, const Vec3& origin, const Vec3& direction) {
    double enter = 0, leave = 1e300;
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
