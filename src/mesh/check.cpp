// SPDX-License-Identifier: Apache-2.0
#include "mesh/check.h"

#include "mesh/patches.h"

#include <cstdlib>
#include <numeric>
#include <utility>
#include <vector>

namespace raycontact {
namespace {

class DisjointSets {
public:
    explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
    std::uint32_t find(std::uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void unite(std::uint32_t i, std::uint32_t k) {
        i = find(i);
        k = find(k);
        parent_[std::max(i, k)] = std::min(i, k);
    }
    std::uint64_t count() const {
        std::uint64_t roots = 0;
        for (std::size_t i = 0; i < parent_.size(); ++i) roots += parent_[i] == i ? 1 : 0;
        return roots;
    }

private:
    std::vector<std::uint32_t> parent_;
};

} // namespace

Topology check_topology(std::span<const Triangle> triangles, std::span<const HalfEdge> edges,
                        std::uint32_t vertex_count) {
    Topology topology;
    // Corners of triangles that follow each other around a vertex end in one set: a fan.
    DisjointSets fans(3 * triangles.size()), components(vertex_count);
    const auto corner_at = [&](const HalfEdge& side, std::uint32_t vertex) {
        const std::uint32_t start = side.corner, end = side.corner - side.corner % 3 + (side.corner % 3 + 1) % 3;
        return triangles[side.triangle()][start % 3] == vertex ? start : end;
    };
    for_each_edge(edges, [&](std::span<const HalfEdge> sides) {
        int balance = 0;
        for (const HalfEdge& side : sides) {
            balance += side.forward ? 1 : -1;
            fans.unite(corner_at(side, side.lo), corner_at(sides[0], side.lo));
            fans.unite(corner_at(side, side.hi), corner_at(sides[0], side.hi));
        }
        topology.closed = topology.closed && sides.size() % 2 == 0;
        topology.manifold = topology.manifold && sides.size() <= 2;
        // As many one way as the other; of an odd number one is left over. A border has nothing to agree with.
        topology.oriented = topology.oriented && std::abs(balance) <= static_cast<int>(sides.size() % 2);
        components.unite(sides[0].lo, sides[0].hi);
    });
    std::vector<std::uint32_t> fan_of(vertex_count, 0xffffffffu);
    for (std::uint32_t corner = 0; corner < 3 * triangles.size(); ++corner) {
        std::uint32_t& fan = fan_of[triangles[corner / 3][corner % 3]];
        const std::uint32_t own = fans.find(corner);
        if (fan == 0xffffffffu) fan = own;
        topology.manifold = topology.manifold && fan == own;
    }
    topology.components = components.count();
    return topology;
}

} // namespace raycontact
