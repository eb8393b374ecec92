// SPDX-License-Identifier: Apache-2.0
#include "broadphase/device_broad_phase.h"

#include "device/launch.h"

#include <algorithm>
#include <utility>

namespace raycontact {

namespace {

using kernels::uint;
using kernels::prototype::nodes_below;
using kernels::prototype::nodes_of;

// A body near more others than this, or than this share of all, is wide: their table stays below what pairs take.
constexpr std::size_t few = 128, few_of = 256;
// An order serves until it costs this much more than when it was new.
constexpr double slower = 1.3;
// Steps after which wide bodies are looked for anew.
constexpr unsigned steps_wide = 32;
constexpr std::size_t most_wide = 1 << 24; // items of their table, 16 bytes each
constexpr uint columns = 3;                // of count_partners

uint number(std::size_t size) {
    return Count(size).value;
}

std::size_t blocks_of(std::size_t items, std::size_t block) {
    return (items + block - 1) / block;
}

bool before(const kernels::PairBodies& p, const kernels::PairBodies& q) {
    return SlotPair(p.first, p.second) < SlotPair(q.first, q.second);
}

SlotPair slot_pair(const kernels::PairBodies& pair) {
    return {pair.first, pair.second};
}

} // namespace

bool DeviceBroadPhase::find(Device& device, const Changes& changes, std::vector<SlotPair>& pairs) {
    if (changes.slots == 0) {
        *this = {};
        return !std::exchange(pairs, {}).empty();
    }
    try {
        tell(device, changes);
        const bool sorts = std::exchange(sorts_next_, false);
        if (sorts) sort(device);
        fill(device);
        do search(device);
        while (!read(device) && !gave_up_);
        if (gave_up_) {
            *this = {};
            gave_up_ = true;
            return false;
        }
        if (sorts) tests_when_sorted_ = tests_;
        // Bodies that are wide are tested by no tree: only a new order tells whether they still are.
        wide_steps_ = wide_slots_.empty() ? 0 : wide_steps_ + 1;
        sorts_next_ = tests_ > slower * tests_when_sorted_ || wide_steps_ >= steps_wide;
        return take(pairs);
    } catch (...) {
        *this = {};
        throw;
    }
}

void DeviceBroadPhase::tell(Device& device, const Changes& changes) {
    if (changes.slots != slots()) {
        const uint slots = number(changes.slots);
        levels_ = 1;
        while (levels_ < PAIR_LEVELS && nodes_of(slots, levels_ - 1) > 1) ++levels_;
        tree_.resize(device, nodes_below(slots, levels_));
        resize(device, slots, extents_, boxes_, keys_);
        totals_.resize(device, 1);
        host_order_.resize(slots);
        for (uint i = 0; i < slots; ++i) host_order_[i] = {0, i};
        order_.write(device, host_order_);
        sorts_next_ = true;
    }
    changed_.write(device, changes.extents);
    moved_.write(device, changes.moved);
    launch<KernelId::set_extents>(device, changes.extents.size(), changed_, extents_);
    launch<KernelId::make_boxes>(device, changes.moved.size() / changes.places, number(changes.places), moved_,
                                 extents_, boxes_);
}

void DeviceBroadPhase::fill(Device& device) {
    const uint slots = number(boxes_.size());
    for (uint level = 0; level == 0 || level + 1 < levels_; ++level) {
        const uint nodes = level + 1 < levels_ ? NODE_LANES * nodes_of(slots, level + 1) : nodes_of(slots, level);
        launch<KernelId::fill_nodes>(device, nodes, level, levels_, slots, order_, boxes_, tree_);
    }
}

// By digits, the lowest first, and stable: any order is right, but each run has the same one. The bounds of all boxes
// are in a tree of any order.
void DeviceBroadPhase::sort(Device& device) {
    fill(device);
    const std::size_t slots = boxes_.size(), blocks = blocks_of(slots, BLOCK_KEYS), counts = DIGITS * blocks;
    launch<KernelId::make_keys>(device, slots, levels_, tree_, boxes_, keys_);
    digits_.resize(device, 1, counts);
    for (uint pass = 0; pass < 3 * KEY_BITS / DIGIT_BITS; ++pass) {
        const bool odd = pass % 2 != 0;
        const Array<kernels::SortKey>&from = odd ? order_ : keys_, &to = odd ? keys_ : order_;
        launch<KernelId::count_digits>(device, blocks, pass * DIGIT_BITS, number(slots), from, digits_.values());
        digits_.scan(device, counts, totals_, 0, slots);
        launch<KernelId::move_keys>(device, blocks, pass * DIGIT_BITS, number(slots), from, digits_.firsts(), to);
    }
    static_assert(3 * KEY_BITS / DIGIT_BITS % 2 == 1, "the last pass ends in order_");
    host_wide_.assign(slots, 0);
    is_wide_.write(device, host_wide_);
    wide_steps_ = 0;
    wide_slots_.clear();
    wide_.write(device, wide_slots_);
}

void DeviceBroadPhase::search(Device& device) {
    const std::size_t slots = boxes_.size(), items = slots + wide_slots_.size() * blocks_of(slots, BLOCK_BODIES);
    const Array<kernels::PairBodies>& pairs = found_.room(device);
    counts_.resize(device, columns, items);
    launch<KernelId::count_partners>(device, items, number(slots), levels_, number(std::max(few, slots / few_of)),
                                     tree_, order_, boxes_, wide_, is_wide_, counts_.values());
    counts_.scan(device, items, totals_, 0, pairs.size());
    launch<KernelId::write_partners>(device, items_of(totals_, 0, items), number(slots), levels_, tree_, order_, boxes_,
                                     wide_, counts_.values(), counts_.firsts(), pairs);
}

// False if it must be done again: a body turned out to be wide, or the pairs had too little room.
bool DeviceBroadPhase::read(Device& device) {
    kernels::Totals totals{};
    const Piece pieces[] = {totals_.piece({&totals, 1}), found_.piece()};
    device.queue().read(pieces);
    tests_ = std::exchange(totals.sums[2], 0); // no result: it may exceed 32 bits
    check_sums({&totals, 1});
    if (totals.sums[1] > 0) {
        list_wide(device);
        return false;
    }
    return found_.take(device, totals.sums[0]);
}

void DeviceBroadPhase::list_wide(Device& device) {
    is_wide_.read(device, host_wide_);
    wide_slots_.clear();
    for (uint slot = 0; slot < host_wide_.size(); ++slot)
        if (host_wide_[slot] != 0) wide_slots_.push_back(slot);
    wide_.write(device, wide_slots_);
    gave_up_ = wide_slots_.size() * blocks_of(host_wide_.size(), BLOCK_BODIES) > most_wide;
}

// Those of wide bodies lie behind the others; both are sorted.
bool DeviceBroadPhase::take(std::vector<SlotPair>& pairs) {
    const std::span<const kernels::PairBodies> found = found_.values();
    const auto same = [](const kernels::PairBodies& own, const SlotPair& pair) { return slot_pair(own) == pair; };
    if (wide_slots_.empty()) {
        if (std::ranges::equal(found, pairs, same)) return false;
        pairs.resize(found.size());
        std::ranges::transform(found, pairs.begin(), slot_pair);
        return true;
    }
    const auto middle = std::is_sorted_until(found.begin(), found.end(), before);
    next_.clear();
    auto wide = middle;
    for (auto own = found.begin(); own != middle; ++own) {
        for (; wide != found.end() && before(*wide, *own); ++wide) next_.push_back(slot_pair(*wide));
        next_.push_back(slot_pair(*own));
    }
    for (; wide != found.end(); ++wide) next_.push_back(slot_pair(*wide));
    if (next_ == pairs) return false;
    pairs.swap(next_);
    return true;
}

} // namespace raycontact
