// SPDX-License-Identifier: Apache-2.0
#include "edges/near_triangles.h"

#include <array>

namespace raycontact {

namespace {

void add(void* list, const TrianglePair* pairs, std::uint32_t count) {
    auto& found = *static_cast<std::vector<TrianglePair>*>(list);
    found.insert(found.end(), pairs, pairs + count);
}

} // namespace

void find_near_triangles(const SourceMesh& first_to_second, double margin, std::vector<TrianglePair>& found) {
    const SourceMesh& placed = first_to_second;
    const ShapeData &first = placed.source, &second = placed.target;
    trees::TwoTrees trees{};
    trees.first = {first.nodes.data(), first.triangle_blocks.data(), first.block_bounds.data()};
    trees.second = {second.nodes.data(), second.triangle_blocks.data(), second.block_bounds.data()};
    for (std::size_t i = 0; i < 9; ++i) trees.rotation[i] = static_cast<float>(placed.pose.rotation[i]);
    const Vec3& t = placed.pose.translation;
    for (std::size_t i = 0; i < 3; ++i) trees.translation[i] = static_cast<float>(axis(t, i));
    trees.span = -1; // every triangle's edges are asked
    // Covers the hair of both, and the rounding of floats.
    trees.apart = static_cast<float>(margin + 2.1 * placed.hair + 2e-6 * (first.reach + second.reach + length(t)));
    std::array<TrianglePair, 256> pairs;
    trees.pairs = pairs.data();
    trees.room = static_cast<std::uint32_t>(pairs.size());
    trees.list = &found;
    trees.flush = &add;
    trees::usable_walks().front()->near_triangles(trees);
}

} // namespace raycontact
