// SPDX-License-Identifier: Apache-2.0
#include "edges/regions.h"

#include "shape/around.h"

#include <algorithm>

namespace raycontact {

void Regions::find(const PairMeshes& pair, const Loops& loops, const EdgePieces& pieces,
                   std::span<const TouchingVertex> touching) {
    touching_ = touching;
    join(pair, loops, pieces);
    regions_.clear();
    for (std::uint32_t i = 0; i < region_of_.size(); ++i) {
        const std::uint32_t root = sets_.of(i); // the lowest, so seen already
        if (root == i) {
            region_of_[i] = static_cast<std::uint32_t>(regions_.size());
            regions_.emplace_back().leads = !pair.of_sheets();
        } else {
            region_of_[i] = region_of_[root];
        }
    }
    for (const Loop& loop : loops.loops()) {
        Region& region = regions_[region_of_[loop.first]];
        region.area = region.area + loop.area;
        region.area_sum += length(loop.area);
    }
    for (const TouchingVertex& v : touching_) {
        const Vec3 n = pair.normal(1 - v.side(), v.face);
        regions_[region_of_[node_of(v)]].tell(v.depth, v.side() == 0 ? n : -1.0 * n);
    }
}

void Regions::join(const PairMeshes& pair, const Loops& loops, const EdgePieces& pieces) {
    first_vertex_ = static_cast<std::uint32_t>(loops.crossings().size());
    ends_.clear();
    for (const EdgePiece& piece : pieces.all())
        if (!piece.is_through()) ends_.emplace_back(vertex_of(pair, piece), piece.crossing());
    std::sort(ends_.begin(), ends_.end());
    std::uint32_t node = first_vertex_ + static_cast<std::uint32_t>(touching_.size());
    sets_.reset(node);
    for (const LoopSegment& s : loops.segments()) sets_.join(s.from, s.to);
    for (const EdgePiece& piece : pieces.all())
        if (piece.is_through()) sets_.join(piece.crossings[0], piece.crossings[1]);
    std::size_t at = 0;
    std::uint64_t last = ~std::uint64_t{0};
    for (const auto& [vertex, crossing] : ends_) {
        while (at < touching_.size() && touching_[at].vertex < vertex) ++at;
        if (at < touching_.size() && touching_[at].vertex == vertex) {
            sets_.join(crossing, node_of(touching_[at]));
            continue;
        }
        if (vertex != last) node = sets_.add();
        last = vertex;
        sets_.join(crossing, node);
    }
    region_of_.assign(sets_.size(), NONE);
    if (touching_.size() > 1) join_vertices(pair, pieces);
}

// Vertices in contact with their neighbours, over edges that stay in the other body.
void Regions::join_vertices(const PairMeshes& pair, const EdgePieces& pieces) {
    for (std::size_t side = 0; side < 2; ++side)
        if (node_at_[side].size() < pair.shape(side).points.size())
            node_at_[side].resize(pair.shape(side).points.size(), NONE);
    for (const TouchingVertex& v : touching_) node_at_[v.side()][v.number()] = node_of(v);
    for (const TouchingVertex& v : touching_) {
        const std::size_t side = v.side();
        const std::uint32_t own = v.number();
        const ShapeData& shape = pair.shape(side);
        const auto join = [&](std::uint32_t other) {
            const std::uint32_t node = node_at_[side][other];
            if (other < own || node == NONE) return; // below: joined there
            if (sets_.of(node) == sets_.of(node_of(v))) return;
            if (!std::ranges::binary_search(pieces.crossed(), std::array{v.vertex, vertex_of_side(side, other)}))
                sets_.join(node, node_of(v));
        };
        any_neighbour(shape, own, [&](std::uint32_t other) {
            join(other);
            return false;
        });
    }
    for (const TouchingVertex& v : touching_) node_at_[v.side()][v.number()] = NONE;
}

} // namespace raycontact
