// SPDX-License-Identifier: Apache-2.0
#include "edges/edge_pieces.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace raycontact {

void EdgePieces::list(const PairMeshes& pair, std::span<const Crossing> crossings) {
    pieces_.clear();
    crossed_.clear();
    by_edge_.resize(crossings.size());
    std::iota(by_edge_.begin(), by_edge_.end(), 0u);
    std::ranges::sort(by_edge_, {}, [&](std::uint32_t i) {
        const Crossing& c = crossings[i];
        return std::tie(c.side, c.edge, c.at, c.face);
    });
    for (std::size_t begin = 0, end = 0; begin < by_edge_.size(); begin = end) {
        const std::uint32_t side = crossings[by_edge_[begin]].side, edge = crossings[by_edge_[begin]].edge;
        const auto on_edge = [&](std::uint32_t i) { return crossings[i].side == side && crossings[i].edge == edge; };
        while (end < by_edge_.size() && on_edge(by_edge_[end])) ++end;
        const auto ends = ends_of(pair.shape(side), edge);
        const auto [low, high] = std::minmax(ends[0], ends[1]);
        crossed_.push_back({vertex_of_side(side, low), vertex_of_side(side, high)});
        if (!pair.holds_edges(1 - side)) continue;
        // The piece before crossing k, if it is inside.
        for (std::size_t k = begin; k <= end; ++k) {
            EdgePiece piece{side, edge, {k > begin ? by_edge_[k - 1] : NONE, k < end ? by_edge_[k] : NONE}, {}};
            const auto [enters, leaves] = piece.crossings;
            if ((enters != NONE && crossings[enters].leaves) || (leaves != NONE && !crossings[leaves].leaves)) continue;
            for (std::size_t e = 0; e < 2; ++e)
                piece.ends[e] =
                    piece.crossings[e] != NONE ? crossings[piece.crossings[e]].point : pair.vertex(side, ends[e]);
            pieces_.push_back(piece);
        }
    }
    std::sort(crossed_.begin(), crossed_.end());
}

} // namespace raycontact
