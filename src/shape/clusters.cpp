// SPDX-License-Identifier: Apache-2.0
#include "shape/clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace raycontact {

namespace {

using kernels::uint;
constexpr std::size_t lanes = VERTEX_LANES;
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

float coordinate(const Point3f& p, int axis) {
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

// Splits along the longest side at a multiple of the largest power of sixteen that fits, so that every level of the
// tree groups neighbours.
void order_by_place(const std::vector<Point3f>& points, std::span<uint> vertices) {
    if (vertices.size() <= lanes) {
        std::sort(vertices.begin(), vertices.end());
        return;
    }
    float low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = high[axis] = coordinate(points[vertices[0]], axis);
        for (const uint v : vertices) {
            low[axis] = std::min(low[axis], coordinate(points[v], axis));
            high[axis] = std::max(high[axis], coordinate(points[v], axis));
        }
    }
    int longest = 0;
    for (int axis = 1; axis < 3; ++axis)
        if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
    std::size_t unit = lanes;
    while (unit * lanes < vertices.size()) unit *= lanes;
    const std::size_t units = (vertices.size() + unit - 1) / unit;
    const std::size_t left = unit * (units / 2);
    std::nth_element(vertices.begin(), vertices.begin() + static_cast<std::ptrdiff_t>(left), vertices.end(),
                     [&](uint a, uint b) {
                         const float x = coordinate(points[a], longest), y = coordinate(points[b], longest);
                         return x != y ? x < y : a < b;
                     });
    order_by_place(points, vertices.first(left));
    order_by_place(points, vertices.subspan(left));
}

struct Bounds {
    float low[3] = {nan, nan, nan}, high[3] = {nan, nan, nan};
    void add(int axis, float from, float to) {
        // Written so that the first value replaces NaN.
        if (!(low[axis] <= from)) low[axis] = from;
        if (!(high[axis] >= to)) high[axis] = to;
    }
};

} // namespace

void build_clusters(ShapeData& shape) {
    std::vector<uint> order;
    for (uint v = 0; v < shape.points.size(); ++v)
        if (shape.exit_distances[v] > 0) order.push_back(v);
    order_by_place(shape.points, order);

    std::vector<Bounds> below;
    for (std::size_t first = 0; first < order.size(); first += lanes) {
        kernels::VertexBlock block;
        Bounds bounds;
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const bool empty = first + lane >= order.size();
            const uint v = empty ? NONE : order[first + lane];
            for (int axis = 0; axis < 3; ++axis) {
                block.position[axis][lane] = empty ? nan : coordinate(shape.points[v], axis);
                const Vec3 n = empty ? Vec3{} : shape.vertex_normals[v];
                block.direction[axis][lane] = -static_cast<float>(axis == 0 ? n.x : axis == 1 ? n.y : n.z);
                if (!empty) bounds.add(axis, block.position[axis][lane], block.position[axis][lane]);
            }
            block.exit[lane] = empty ? 0.0f : std::min(shape.exit_distances[v], UNBOUNDED);
            block.vertex[lane] = v;
        }
        shape.vertex_blocks.push_back(block);
        below.push_back(bounds);
    }
    shape.header.vertex_block_count = static_cast<uint>(shape.vertex_blocks.size());

    // The top level may hold several blocks; the walk takes them in turn.
    uint level = 0;
    do {
        shape.header.cluster_first[level] = static_cast<uint>(shape.clusters.size());
        std::vector<Bounds> here;
        for (std::size_t first = 0; first < below.size(); first += lanes) {
            kernels::ClusterBlock block;
            Bounds all;
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                const Bounds bounds = first + lane < below.size() ? below[first + lane] : Bounds{};
                for (int axis = 0; axis < 3; ++axis) {
                    const float low = bounds.low[axis], high = bounds.high[axis];
                    const float centre = 0.5f * low + 0.5f * high;
                    // A share of the shape's size, so that no rounding on the way into any target's frame matters.
                    const float slack = 1.0e-6f * static_cast<float>(shape.diagonal);
                    block.centre[axis][lane] = centre;
                    block.half_size[axis][lane] = std::max(high - centre, centre - low) + slack;
                    if (low <= high) all.add(axis, low, high);
                }
            }
            shape.clusters.push_back(block);
            here.push_back(all);
        }
        shape.header.cluster_count[level] = static_cast<uint>(here.size());
        below = std::move(here);
        ++level;
    } while (below.size() > 1 && level < CLUSTER_LEVELS);
    shape.header.cluster_levels = level;
}

} // namespace raycontact
