// SPDX-License-Identifier: Apache-2.0
#include "mesh/triangle_bvh.h"

#include "executor/divide.h"
#include "mesh/triangle_distance.h"

#include <algorithm>
#include <array>
#include <utility>

namespace raycontact {

namespace {

constexpr std::uint32_t leaf = TriangleBvh::leaf_size;

/// How many nodes cover n triangles, and n + 1.
std::pair<std::uint32_t, std::uint32_t> node_counts(std::uint32_t n) {
    if (n + 1 <= leaf) return {1, 1};
    const std::pair below = node_counts(n / 2);
    const auto half = [&](std::uint32_t m) { return m == n / 2 ? below.first : below.second; };
    const auto both = [&](std::uint32_t m) { return m <= leaf ? 1 : 1 + half(m / 2) + half(m - m / 2); };
    return {both(n), both(n + 1)};
}

} // namespace

/// What the triangles are sorted by.
struct TriangleBvh::Sorting {
    std::vector<Box> boxes;
    std::vector<Vec3> sums; ///< of the corners
    std::vector<std::pair<double, std::uint32_t>> keys;
};

TriangleBvh::TriangleBvh(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                         std::vector<std::uint32_t> chosen, Executor& executor)
    : vertices_(vertices), triangles_(triangles), order_(std::move(chosen)) {
    build(executor);
}

void TriangleBvh::build(Executor& executor) {
    const auto count = static_cast<std::uint32_t>(order_.size());
    nodes_.resize(node_counts(count).first);
    boxes_.resize(count);
    Sorting sorting;
    sorting.boxes.resize(triangles_.size());
    sorting.sums.resize(triangles_.size());
    sorting.keys.resize(count);
    executor.run(count, 4096, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) {
            const auto [a, b, c] = triangles_[order_[i]];
            const Vec3 &p = vertices_[a], &q = vertices_[b], &r = vertices_[c];
            sorting.boxes[order_[i]] = {least(least(p, q), r), most(most(p, q), r)};
            sorting.sums[order_[i]] = p + q + r;
        }
    });
    constexpr std::uint32_t large = 4096;
    const auto parts = divide(
        executor, Part{0, 0, count}, [](const Part& part) { return part.last - part.first > large; },
        [&](const Part& part) { return split(part, sorting); });
    for_each_part(executor, parts, [&](const Part& part) { build_below(part, sorting); });
}

/// Fills the part's node, with the places of both children.
std::array<TriangleBvh::Part, 2> TriangleBvh::split(const Part& part, Sorting& sorting) {
    const auto [node, first, last] = part;
    Box box = sorting.boxes[order_[first]];
    for (std::uint32_t i = first + 1; i < last; ++i) box.add(sorting.boxes[order_[i]]);
    const std::uint32_t middle = first + (last - first) / 2;
    const std::uint32_t right = last - first <= leaf_size ? 0 : node + 1 + node_counts(middle - first).first;
    nodes_[node] = {box, first, last, right};
    if (right == 0) return {};

    const Vec3 size = box.high - box.low;
    const std::size_t k = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto keys = sorting.keys.begin();
    for (std::uint32_t i = first; i < last; ++i) keys[i] = {axis(sorting.sums[order_[i]], k), order_[i]};
    std::nth_element(keys + first, keys + middle, keys + last);
    for (std::uint32_t i = first; i < last; ++i) order_[i] = keys[i].second;
    return {Part{node + 1, first, middle}, Part{right, middle, last}};
}

void TriangleBvh::build_below(const Part& part, Sorting& sorting) {
    const auto [left, right] = split(part, sorting);
    if (nodes_[part.node].right != 0) {
        build_below(left, sorting);
        return build_below(right, sorting);
    }
    for (std::uint32_t i = part.first; i < part.last; ++i) boxes_[i] = sorting.boxes[order_[i]];
}

/// Pairs of nodes that together cover all pairs of triangles whose boxes touch; about as many as wanted.
std::vector<TriangleBvh::NodePair> TriangleBvh::node_pairs(std::size_t wanted) const {
    std::vector<NodePair> open{{0, 0}};
    for (bool opened = true; opened && open.size() < wanted;) {
        opened = false;
        std::vector<NodePair> next;
        for (const auto& [a, b] : open) {
            const Node &left = nodes_[a], &right = nodes_[b];
            if (!left.box.touches(right.box)) continue;
            if (left.right == 0 || right.right == 0) {
                next.push_back({a, b});
                continue;
            }
            opened = true;
            if (a == b) {
                next.insert(next.end(), {{a + 1, a + 1}, {left.right, left.right}, {a + 1, left.right}});
            } else if (left.size() >= right.size()) {
                next.insert(next.end(), {{a + 1, b}, {left.right, b}});
            } else {
                next.insert(next.end(), {{a, b + 1}, {a, right.right}});
            }
        }
        open = std::move(next);
    }
    return open;
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
