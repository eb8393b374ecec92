// SPDX-License-Identifier: Apache-2.0
#include "schedule/assignment.h"

#include <algorithm>
#include <utility>

namespace raycontact {

void Assignment::assign(const OpenPairs& pairs, std::span<const PlacedBody> bodies, bool has_rounds, Balance& balance) {
    pairs_ = &pairs;
    const PairSlots& all = pairs.slots();
    const auto goes_to_none = [&](std::uint32_t slot) { return has_rounds && is_round(bodies, all[slot]); };
    if (alone() && has_rounds) {
        divide();
        for (std::uint32_t slot = 0; slot < all.end(); ++slot)
            if (all.is_open(slot) && goes_to_none(slot)) take(slot);
        return;
    }
    if (alone()) return;
    if (!all.changes().is_next(seen_)) {
        for (Own& own : parts_) own.open.clear();
        places_.clear();
    }
    places_.resize(all.end());
    all.changes().each_since(seen_, all.end(), [&](std::uint32_t slot) {
        take(slot);
        if (all.is_open(slot) && !goes_to_none(slot)) put(slot, balance.part_for_new_pair());
    });
}

void Assignment::put(std::uint32_t slot, std::size_t part) {
    Own& own = parts_[part];
    const std::uint32_t place = own.open.open(pairs_->slots()[slot]);
    own.scene_slots.resize(own.open.end());
    own.scene_slots[place] = slot;
    places_[slot] = {static_cast<std::uint32_t>(part), place};
}

void Assignment::take(std::uint32_t slot) noexcept {
    if (places_[slot].part != none) parts_[places_[slot].part].open.close(places_[slot].slot);
    places_[slot] = {};
}

// The one part keeps its slots: what it knows of them stays.
void Assignment::divide() {
    const PairSlots& all = pairs_->slots();
    parts_.front().open = all;
    places_.resize(all.end());
    parts_.front().scene_slots.resize(all.end());
    for (std::uint32_t slot = 0; slot < all.end(); ++slot) {
        parts_.front().scene_slots[slot] = slot;
        places_[slot] = all.is_open(slot) ? Place{0, slot} : Place{};
    }
    seen_ = all.changes().now();
    divided_ = true;
}

void Assignment::add_part() {
    if (alone()) divide();
    parts_.emplace_back();
}

// Slices of the list are counted by part, and then put behind one another.
void Assignment::ask(Executor& executor, const PairList& asked) {
    constexpr std::size_t at_once = 4096;
    asked_ = &asked;
    if (alone()) return;
    const std::size_t parts = parts_.size(), slices = (asked.size() + at_once - 1) / at_once;
    ends_.assign(parts * slices, 0);
    const auto each = [&](std::uint32_t slice, auto&& work) {
        for (std::size_t i = slice * at_once; i < std::min(asked.size(), (slice + 1) * at_once); ++i)
            if (const Place& place = places_[asked.slots[i]]; place.part != none) work(i, place);
    };
    executor.each(slices, 1, [&](std::uint32_t slice) {
        each(slice, [&](std::size_t, const Place& place) { ++ends_[place.part * slices + slice]; });
    });
    for (std::size_t part = 0; part < parts; ++part) {
        std::size_t count = 0;
        for (std::size_t slice = 0; slice < slices; ++slice)
            count += std::exchange(ends_[part * slices + slice], count);
        parts_[part].asked.resize(count);
    }
    executor.each(slices, 1, [&](std::uint32_t slice) {
        each(slice, [&](std::size_t i, const Place& place) {
            parts_[place.part].asked.set(ends_[place.part * slices + slice]++, {asked.pairs[i], place.slot});
        });
    });
}

PairList Assignment::all_on(std::size_t part) const {
    if (pairs_ == nullptr) return {}; // before any step
    const PairSlots& open = open_on(part);
    std::vector<OpenPair> sorted;
    for (std::uint32_t slot = 0; slot < open.end(); ++slot)
        if (open.is_open(slot)) sorted.push_back({open[slot], slot});
    std::ranges::sort(sorted);
    PairList list;
    for (const OpenPair& own : sorted) list.add(own);
    return list;
}

std::vector<PairList> Assignment::give_away(std::span<const std::size_t> from, Balance& balance) {
    std::vector<OpenPair> going; // by the slots of the scene
    for (std::uint32_t slot = 0; slot < places_.size(); ++slot)
        if (places_[slot].part != none && std::ranges::find(from, places_[slot].part) != from.end())
            going.push_back({pairs_->slots()[slot], slot});
    std::ranges::sort(going);
    std::vector<PairList> given(parts_.size());
    for (const auto& [pair, slot] : going) {
        take(slot);
        put(slot, balance.part_for_new_pair());
        given[places_[slot].part].add({pair, places_[slot].slot});
    }
    return given;
}

void Assignment::move(PairList& moving, std::size_t from, std::size_t to) {
    for (std::uint32_t& own : moving.slots) {
        const std::uint32_t slot = parts_[from].scene_slots[own];
        take(slot);
        put(slot, to);
        own = places_[slot].slot;
    }
}

void Assignment::step_done() noexcept {
    for (Own& own : parts_) own.open.step_done();
}

void Assignment::forget() noexcept {
    seen_ = 0;
    for (Own& own : parts_) own.open.forget();
}

} // namespace raycontact
