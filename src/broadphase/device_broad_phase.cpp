// SPDX-License-Identifier: Apache-2.0
#include "broadphase/device_broad_phase.h"

#include "device/launch.h"

#include <algorithm>
#include <array>
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
constexpr std::size_t least_room = 1024;   // for pairs
// Changes that are read with their number: from one step to the next they differ, and so many cost nothing.
constexpr std::size_t least_read = 1024;

uint number(std::size_t size) {
    return Count(size).value;
}

std::size_t blocks_of(std::size_t items, std::size_t block) {
    return (items + block - 1) / block;
}

} // namespace

DeviceBroadPhase::Found DeviceBroadPhase::find(Device& device, const Changes& changes, bool whole) {
    if (changes.slots == 0) {
        *this = {};
        return {true, {}, {}};
    }
    try {
        tell(device, changes);
        const bool sorts = std::exchange(sorts_next_, false);
        if (sorts) sort(device);
        fill(device);
        if (whole) has_last_ = false;
        do {
            search(device);
            // Rows are the same where slots and wide bodies are.
            compares_ = has_last_ && last_wide_ == wide_slots_;
            if (compares_) compare(device);
        } while (!read(device) && !gave_up_);
        if (gave_up_) {
            *this = {};
            gave_up_ = true;
            return {};
        }
        if (sorts) tests_when_sorted_ = tests_;
        // Bodies that are wide are tested by no tree: only a new order tells whether they still are.
        wide_steps_ = wide_slots_.empty() ? 0 : wide_steps_ + 1;
        sorts_next_ = tests_ > slower * tests_when_sorted_ || wide_steps_ >= steps_wide;
        std::swap(list_, last_);
        last_wide_ = wide_slots_;
        has_last_ = true;
        return {!compares_, opened_, closed_};
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
        totals_.resize(device, 2);
        host_order_.resize(slots);
        for (uint i = 0; i < slots; ++i) host_order_[i] = {0, i};
        order_.write(device, host_order_);
        sorts_next_ = true;
        has_last_ = false;
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
    const std::size_t slots = boxes_.size(), rows = slots + wide_slots_.size() * blocks_of(slots, BLOCK_BODIES);
    const uint wides = number(wide_slots_.size());
    Columns& counts = list_.counts;
    Array<kernels::PairBodies>& pairs = list_.pairs;
    pairs.grow(device, std::max(least_room, last_.count));
    counts.resize(device, columns, rows);
    launch<KernelId::count_partners>(device, rows, number(slots), levels_, number(std::max(few, slots / few_of)), tree_,
                                     order_, boxes_, wides, wide_, is_wide_, counts.values());
    counts.scan(device, rows, totals_, 0, pairs.size());
    launch<KernelId::write_partners>(device, items_of(totals_, 0, rows), number(slots), levels_, tree_, order_, boxes_,
                                     wides, wide_, counts.values(), counts.firsts(), pairs);
}

void DeviceBroadPhase::compare(Device& device) {
    const std::size_t rows = list_.counts.stride();
    changes_.resize(device, 1, rows);
    launch<KernelId::count_changed_pairs>(device, rows, totals_, number(list_.pairs.size()), list_.counts.values(),
                                          list_.counts.firsts(), list_.pairs, last_.counts.values(),
                                          last_.counts.firsts(), last_.pairs, changes_.values());
    write_changes(device);
}

void DeviceBroadPhase::write_changes(Device& device) {
    const std::size_t rows = list_.counts.stride();
    const Array<kernels::PairDifference>& changed = changed_pairs_.room(device);
    changes_.scan(device, rows, totals_, 1, changed.size());
    launch<KernelId::write_changed_pairs>(
        device, items_of(totals_, 1, rows), list_.counts.values(), list_.counts.firsts(), list_.pairs,
        last_.counts.values(), last_.counts.firsts(), last_.pairs, changes_.values(), changes_.firsts(), changed);
}

// False if it must be done again: a body turned out to be wide, or the pairs had too little room.
bool DeviceBroadPhase::read(Device& device) {
    std::array<kernels::Totals, 2> totals{};
    const std::size_t scans = compares_ ? 2 : 1;
    const auto made = std::span(totals).first(scans);
    const Piece pieces[] = {totals_.piece(made), changed_pairs_.piece(least_read)};
    device.queue().read(std::span(pieces).first(scans));
    tests_ = std::exchange(totals[0].sums[2], 0); // no result: it may exceed 32 bits
    check_sums(made);
    if (totals[0].sums[1] > 0) {
        list_wide(device);
        return false;
    }
    list_.count = totals[0].sums[0];
    if (list_.count > list_.pairs.size()) {
        list_.pairs.grow(device, list_.count);
        return false;
    }
    if (compares_)
        take_changes(device, totals[1].sums[0]);
    else
        take_all(device);
    return true;
}

void DeviceBroadPhase::list_wide(Device& device) {
    is_wide_.read(device, host_wide_);
    wide_slots_.clear();
    for (uint slot = 0; slot < host_wide_.size(); ++slot)
        if (host_wide_[slot] != 0) wide_slots_.push_back(slot);
    wide_.write(device, wide_slots_);
    gave_up_ = wide_slots_.size() * blocks_of(host_wide_.size(), BLOCK_BODIES) > most_wide;
}

void DeviceBroadPhase::take_all(Device& device) {
    std::vector<kernels::PairBodies> all(list_.count);
    if (!all.empty()) list_.pairs.read(device, all);
    opened_.resize(all.size());
    std::ranges::transform(all, opened_.begin(), [](const auto& pair) { return SlotPair(pair.first, pair.second); });
    closed_.clear();
}

void DeviceBroadPhase::take_changes(Device& device, std::size_t count) {
    if (!changed_pairs_.take(device, count)) { // there is room now
        write_changes(device);
        const Piece piece = changed_pairs_.piece(least_read);
        device.queue().read({&piece, 1});
        changed_pairs_.take(device, count);
    }
    opened_.clear();
    closed_.clear();
    for (const kernels::PairDifference& one : changed_pairs_.values())
        (one.opened != 0 ? opened_ : closed_).emplace_back(one.first, one.second);
}

} // namespace raycontact
