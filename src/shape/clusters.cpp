// SPDX-License-Identifier: Apache-2.0
#include "executor/divide.h"
#include "mesh/vector.h"
#include "shape/build.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact {

namespace {

using kernels::uint;
constexpr std::size_t lanes = VERTEX_LANES;
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

using Key = std::pair<float, uint>; // a coordinate and its vertex

// Splits along the longest side at a multiple of the largest power of sixteen that fits, so that every level of the
// tree groups neighbours.
// Returns how many come first.
std::size_t split_by_place(const ShapeData& shape, std::span<uint> vertices, std::vector<Key>& keys) {
    Point3f low = shape.points[vertices[0]], high = low;
    for (const uint v : vertices) {
        const Point3f& p = shape.points[v];
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    float Point3f::*longest = &Point3f::x;
    for (float Point3f::*const side : {&Point3f::y, &Point3f::z})
        if (high.*side - low.*side > high.*longest - low.*longest) longest = side;
    std::size_t unit = lanes;
    while (unit * lanes < vertices.size()) unit *= lanes;
    const std::size_t units = (vertices.size() + unit - 1) / unit, left = unit * (units / 2);
    keys.clear();
    for (const uint v : vertices) keys.emplace_back(shape.points[v].*longest, v);
    std::nth_element(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(left), keys.end());
    for (std::size_t i = 0; i < keys.size(); ++i) vertices[i] = keys[i].second;
    return left;
}

void order_below(const ShapeData& shape, std::span<uint> vertices, std::vector<Key>& keys) {
    if (vertices.size() <= lanes) {
        std::ranges::sort(vertices);
        return;
    }
    const std::size_t left = split_by_place(shape, vertices, keys);
    order_below(shape, vertices.first(left), keys);
    order_below(shape, vertices.subspan(left), keys);
}

void order_by_place(const ShapeData& shape, std::span<uint> all, Executor& executor) {
    constexpr std::size_t large = 1 << 13;
    using Part = std::span<uint>;
    const auto parts = divide(
        executor, all, [](const Part& part) { return part.size() > large; },
        [&](const Part& part) {
            std::vector<Key> keys;
            const std::size_t left = split_by_place(shape, part, keys);
            return std::array{part.first(left), part.subspan(left)};
        });
    for_each_part(executor, parts, [&](const Part& part) {
        std::vector<Key> keys;
        order_below(shape, part, keys);
    });
}

// Empty (NaN) until something is added.
struct Bounds {
    float low[3] = {nan, nan, nan}, high[3] = {nan, nan, nan};
    void add(std::size_t k, float from, float to) { // fmin and fmax prefer a number to NaN
        low[k] = std::fmin(low[k], from);
        high[k] = std::fmax(high[k], to);
    }
};

} // namespace

void build_clusters(ShapeData& shape, Executor& executor) {
    std::vector<uint> order;
    for (uint v = 0; v < shape.points.size(); ++v)
        if (shape.exit_distances[v] > 0) order.push_back(v);
    order_by_place(shape, order, executor);

    std::vector<Bounds> below;
    for (std::size_t first = 0; first < order.size(); first += lanes) {
        kernels::VertexBlock& block = shape.vertex_blocks.emplace_back();
        Bounds& bounds = below.emplace_back();
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const bool empty = first + lane >= order.size();
            const uint v = empty ? NONE : order[first + lane];
            const Vec3 n = empty ? Vec3{} : shape.vertex_normals[v];
            const Vec3 p = empty ? Vec3{nan, nan, nan} : shape.point(v);
            for (std::size_t k = 0; k < 3; ++k) {
                block.position[k][lane] = static_cast<float>(axis(p, k));
                block.direction[k][lane] = -static_cast<float>(axis(n, k));
                bounds.add(k, block.position[k][lane], block.position[k][lane]);
            }
            block.exit[lane] = empty ? 0.0f : std::min(shape.exit_distances[v], UNBOUNDED);
            block.vertex[lane] = v;
        }
    }
    shape.header.vertex_block_count = static_cast<uint>(shape.vertex_blocks.size());

    // Proportional to the shape's size, so that rounding in the transform to a target's frame does not matter.
    const float slack = 1.0e-6f * static_cast<float>(shape.diagonal);
    // The top level may hold several blocks; the traversal takes them in turn.
    uint level = 0;
    do {
        shape.header.cluster_first[level] = static_cast<uint>(shape.clusters.size());
        std::vector<Bounds> here((below.size() + lanes - 1) / lanes);
        shape.header.cluster_count[level] = static_cast<uint>(here.size());
        below.resize(lanes * here.size());
        for (std::size_t i = 0; i < below.size(); ++i) {
            const std::size_t lane = i % lanes;
            if (lane == 0) shape.clusters.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) {
                const float low = below[i].low[k], high = below[i].high[k], centre = 0.5f * low + 0.5f * high;
                shape.clusters.back().centre[k][lane] = centre;
                shape.clusters.back().half_size[k][lane] = std::max(high - centre, centre - low) + slack;
                here[i / lanes].add(k, low, high);
            }
        }
        below = std::move(here);
        ++level;
    } while (below.size() > 1 && level < CLUSTER_LEVELS);
    shape.header.cluster_levels = level;
}

} // namespace raycontact
