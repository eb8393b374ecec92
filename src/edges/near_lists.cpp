// SPDX-License-Identifier: Apache-2.0
#include "edges/near_lists.h"

#include "give_back.h"
#include "shape/shape_data.h"

#include <algorithm>

namespace raycontact {

namespace {

// Shares of the smaller body's size. Lists of pairs that have nothing near last some six steps, others, with edges to
// be asked in every step, some four; a wider search finds so much more that it costs more than it saves.
constexpr double least_reach = 0.005, most_reach = 0.015, reach_in_steps = 6;
constexpr double least_margin = 0.0005, most_margin = 0.005, margin_in_steps = 4;
constexpr double fastest = 0.006; // a step: a list would not last long enough to pay for itself
constexpr std::size_t longest_list = 1u << 24;

double far_margin(double size, double speed) {
    return std::clamp(reach_in_steps * speed, least_reach * size, most_reach * size);
}

double close_margin(double size, double speed) {
    return std::clamp(margin_in_steps * speed, least_margin * size, most_margin * size);
}

// An upper bound of how far any point of one body has come nearer to the other: what either sees will do.
double moved_since(const PairPlace& reference, const PairPlace& now, const PlacedBody& a, const PlacedBody& b) {
    const auto bounds = displacement_bounds(reference, now, a.shape->data().reach, b.shape->data().reach);
    return 1.001 * std::min(bounds[0], bounds[1]);
}

} // namespace

void NearLists::Slice::clear() {
    near_.clear();
    fresh_.clear();
}

void NearLists::Slice::give_back() {
    raycontact::give_back(near_);
    raycontact::give_back(fresh_);
}

void NearLists::clear() {
    table_.clear();
    pool_.clear();
    free_all(lists_);
}

void NearLists::match(std::span<const SlotPair> pairs) {
    // What the few that are left know is worth less than the memory.
    if (is_mostly_empty(table_.slots(), pairs.size())) clear();
    table_.match(pairs, [this](List& list) {
        pool_.release({list.first, list.capacity});
        list = {};
    });
}

NearEdges NearLists::Slice::find(NearSearch& search, const std::array<SourceMesh, 2>& placed, double margin) {
    const std::size_t begin = near_.size(), first = search.find(placed, margin, near_);
    const std::span<const NearEdge> all = std::span<const NearEdge>(near_).subspan(begin);
    return {all.first(first), all.subspan(first)};
}

NearEdges NearLists::near(std::size_t i, const SlotPair& pair, std::span<const PlacedBody> bodies,
                          const std::array<SourceMesh, 2>& placed, const Motion& motion, NearSearch& search,
                          Slice& slice) {
    List& list = table_.state(i);
    Slack& slack = table_.hot(i);
    const bool serves = list.known;
    const auto kept = [&]() -> NearEdges {
        const auto all = std::span<const NearEdge>(lists_).subspan(list.first, list.count());
        return {all.first(list.counts[0]), all.subspan(list.counts[0])};
    };
    if (serves && slack.metres > 0) return kept();
    const PlacedBody &a = bodies[pair.first], &b = bodies[pair.second];
    const PairPlace now = place_pair(a.centred, b.centred, motion.pair_shear(pair));
    if (serves) {
        // Written so that a NaN, for bodies beyond the range of squares, needs a new list.
        const double left = list.margin - moved_since(list.reference, now, a, b) - 2 * mismatch(placed);
        if (left > 0) {
            slack.metres = left;
            return kept();
        }
    }
    const double speed = motion.pair_speed(pair), size = placed[0].size;
    const bool had_none = !list.known || list.count() == 0;
    list.known = speed < fastest * size;
    list.margin = !list.known ? 0 : had_none ? far_margin(size, speed) : close_margin(size, speed);
    const std::size_t first = slice.near_.size();
    const NearEdges near = slice.find(search, placed, list.margin);
    list.known = list.known && near[0].size() + near[1].size() <= longest_list;
    slack = {list.known ? list.margin : -1, false};
    if (list.known) {
        list.reference = now;
        for (std::size_t side = 0; side < 2; ++side) list.counts[side] = static_cast<std::uint32_t>(near[side].size());
        slice.fresh_.push_back({i, first});
    }
    return near;
}

void NearLists::found_apart(std::size_t i) {
    const List& list = table_.state(i);
    table_.hot(i).apart = list.known && list.count() == 0;
}

void NearLists::keep(const Slice& slice) {
    for (const Slice::Fresh& fresh : slice.fresh_) {
        List& list = table_.state(fresh.pair);
        pool_.release({list.first, list.capacity});
        list.capacity = 0; // in case the next line throws
        const RangePool::Range range = pool_.allocate(list.count());
        list.first = range.first;
        list.capacity = range.capacity;
        if (lists_.size() < pool_.end()) lists_.resize(pool_.end());
        std::copy_n(slice.near_.begin() + std::ptrdiff_t(fresh.first), list.count(),
                    lists_.begin() + std::ptrdiff_t(list.first));
    }
}

} // namespace raycontact
