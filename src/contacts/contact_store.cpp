// SPDX-License-Identifier: Apache-2.0
#include "contacts/contact_store.h"

#include "executor/row_slices.h"
#include "free_all.h"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <utility>

namespace raycontact {

namespace {

constexpr std::size_t pairs_at_once = 128, contacts_at_once = 4096;

// All of a feature that its key tells.
ContactFeature feature_of(std::uint64_t key) {
    constexpr std::uint64_t edge = (1u << 31) - 1;
    const std::uint64_t tag = key >> 62;
    if (tag == 2)
        return {FeatureKind::edges, Side::a, static_cast<std::uint32_t>(key >> 31 & edge),
                static_cast<std::uint32_t>(key & edge)};
    if (key >> 60 == 13)
        return {FeatureKind::faces, Side::a, static_cast<std::uint32_t>(key >> 30 & edge >> 1),
                static_cast<std::uint32_t>(key & edge >> 1)};
    const bool is_round = key >> 59 == 25, inside = tag == 3 && !is_round;
    const bool of_b = ((is_round ? key >> 58 : inside ? key >> 32 : tag) & 1) != 0;
    const auto own = static_cast<std::uint32_t>(key);
    constexpr std::uint32_t none = ContactFeature::no_index;
    return {is_round ? FeatureKind::round
            : inside ? FeatureKind::inside
                     : FeatureKind::vertex,
            of_b ? Side::b : Side::a, of_b ? none : own, of_b ? own : none};
}

} // namespace

void ContactStore::Sums::add(const Sums& other) {
    fresh += other.fresh;
    speculative += other.speculative;
    ray_length += other.ray_length;
    depth_max = std::max(depth_max, other.depth_max);
}

bool ContactStore::is_held() const {
    if (contacts_.use_count() > 1) return true;
    std::atomic_thread_fence(std::memory_order_acquire); // after what another thread read before it let go
    return false;
}

void ContactStore::prepare() {
    if (next_.use_count() > 1) next_ = std::make_shared<std::vector<Contact>>();
    std::atomic_thread_fence(std::memory_order_acquire);
}

void ContactStore::clear() noexcept {
    if (is_held()) contacts_.swap(next_);
    contacts_->clear();
    blocks_.clear();
    maybe_new_.clear();
    lost_.clear();
    sums_ = {};
}

void ContactStore::trim() {
    if (next_.use_count() == 1) free_all(*next_);
    if (!is_held()) contacts_->shrink_to_fit();
    free_all(pairs_, slices_, units_, copied_, changed_blocks_);
    blocks_.shrink_to_fit();
    maybe_new_.shrink_to_fit();
    lost_.shrink_to_fit();
}

std::span<const Contact> ContactStore::of(const SlotPair& pair) const {
    const Range range = range_of(pair);
    return all().subspan(range.begin, range.size());
}

// Those of one pair may begin in the block before the first one that begins with them.
ContactStore::Range ContactStore::range_of(const SlotPair& pair) const {
    const std::uint64_t number = pair_number(pair);
    const auto block =
        static_cast<std::size_t>(std::ranges::lower_bound(blocks_, number, {}, &Block::first) - blocks_.begin());
    const std::span<const Contact> contacts = all();
    const std::size_t from = block == 0 ? 0 : (block - 1) * block_size;
    const auto here = contacts.subspan(from, std::min(contacts.size(), block * block_size) - from);
    const std::size_t begin =
        from + static_cast<std::size_t>(std::ranges::lower_bound(here, number, {}, number_of_pair) - here.begin());
    std::size_t end = begin;
    while (end < contacts.size() && number_of_pair(contacts[end]) == number) ++end;
    return {begin, end};
}

void ContactStore::replace(Executor& executor, const Asked& asked, std::vector<Contact>& found) {
    if (asked.all) {
        replace_all(executor, found);
    } else {
        pairs_.clear();
        if (!asked.closed.empty()) std::ranges::set_union(asked.pairs, asked.closed, std::back_inserter(pairs_));
        list_units(executor, asked.closed.empty() ? asked.pairs : pairs_, found);
        if (!moves_ && !is_held())
            replace_units(executor, found);
        else
            move_units(executor, found);
    }
    sum_up();
}

std::span<ContactStore::Slice> ContactStore::begin_slices(std::size_t count) {
    if (slices_.size() < count) slices_.resize(count);
    const std::span<Slice> slices = std::span(slices_).first(count);
    for (Slice& slice : slices) {
        slice.units.clear();
        slice.lost.clear();
        slice.fresh = 0;
    }
    lost_.clear();
    return slices;
}

// Those of some pairs, with those that the same pairs, or pairs that are gone, had before. A slot may have another body
// than it had.
void ContactStore::compare(const Range& old_range, std::span<Contact> found, Slice& slice) const {
    const std::span<const Contact> olds = all().subspan(old_range.begin, old_range.size());
    auto old = olds.begin();
    const auto lose = [&] {
        if (!old->is_speculative()) slice.lost.push_back({old->body_a, old->body_b, feature_of(old->key())});
    };
    for (Contact& contact : found) {
        const ContactOrder own = order_of(contact);
        const bool touches = !contact.is_speculative();
        for (; old != olds.end() && order_of(*old) < own; ++old) lose();
        const bool there = old != olds.end() && order_of(*old) == own;
        const bool known = there && old->body_a == contact.body_a && old->body_b == contact.body_b;
        contact.is_new = !known || (touches && old->is_speculative());
        if (there && !(known && touches)) lose();
        if (there) ++old;
        if (touches && contact.is_new) ++slice.fresh;
    }
    for (; old != olds.end(); ++old) lose();
}

void ContactStore::replace_all(Executor& executor, std::vector<Contact>& found) {
    const RowSlices rows{found.size()};
    const std::span<Slice> slices = begin_slices(rows.count());
    const auto pair_at = [&](std::size_t i) { return number_of_pair(found[i]); };
    rows.each(
        executor, [&](std::size_t i) { return pair_at(i) == pair_at(i - 1); },
        [&](std::uint32_t slice, std::size_t begin, std::size_t end) {
            const auto old = beside(all(), begin, end, found.size(), pair_at, number_of_pair);
            const auto first = static_cast<std::size_t>(old.data() - all().data());
            compare({first, first + old.size()}, std::span(found).subspan(begin, end - begin), slices[slice]);
        });
    found.swap(*next_);
    contacts_.swap(next_);
    fill_all(executor);
    sums_.fresh = 0;
    for (const Slice& slice : slices) {
        sums_.fresh += slice.fresh;
        lost_.insert(lost_.end(), slice.lost.begin(), slice.lost.end());
    }
}

// What becomes of the pairs that have, or had, a contact.
void ContactStore::list_units(Executor& executor, std::span<const SlotPair> pairs, std::vector<Contact>& found) {
    const RowSlices rows{pairs.size(), pairs_at_once};
    const std::span<Slice> slices = begin_slices(rows.count());
    rows.each(
        executor, [](std::size_t) { return false; },
        [&](std::uint32_t s, std::size_t begin, std::size_t end) {
            Slice& slice = slices[s];
            const std::span<const Contact> all_found = found;
            const auto own = beside(
                all_found, begin, end, pairs.size(), [&](std::size_t i) { return pairs[i]; }, pair_of);
            auto at = own.begin();
            for (const SlotPair& pair : pairs.subspan(begin, end - begin)) {
                const auto first = at;
                while (at != own.end() && pair_of(*at) == pair) ++at;
                const Range old = range_of(pair), now{static_cast<std::size_t>(first - all_found.begin()),
                                                      static_cast<std::size_t>(at - all_found.begin())};
                if (old.size() == 0 && now.size() == 0) continue;
                compare(old, std::span(found).subspan(now.begin, now.size()), slice);
                slice.units.push_back({old, now, 0});
            }
        });
    units_.clear();
    moves_ = false;
    sums_.fresh = 0;
    std::size_t more = 0, less = 0;
    for (const Slice& slice : slices) {
        for (const Unit& unit : slice.units) {
            units_.push_back({unit.old, unit.found, unit.old.begin + more - less});
            more += unit.found.size();
            less += unit.old.size();
            if (unit.found.size() != unit.old.size()) moves_ = true;
        }
        sums_.fresh += slice.fresh;
        lost_.insert(lost_.end(), slice.lost.begin(), slice.lost.end());
    }
}

void ContactStore::replace_units(Executor& executor, const std::vector<Contact>& found) {
    forget_new(executor);
    changed_blocks_.clear();
    maybe_new_.clear();
    for (const Unit& unit : units_) {
        for (std::size_t block = unit.old.begin / block_size; block <= (unit.old.end - 1) / block_size; ++block)
            if (changed_blocks_.empty() || changed_blocks_.back() < block) changed_blocks_.push_back(block);
        maybe_new_.push_back({unit.to, unit.to + unit.found.size()});
    }
    executor.each(units_.size(), 64, [&](std::uint32_t i) {
        const Unit& unit = units_[i];
        std::copy_n(found.begin() + std::ptrdiff_t(unit.found.begin), unit.found.size(),
                    contacts_->begin() + std::ptrdiff_t(unit.to));
    });
    executor.each(changed_blocks_.size(), 16, [&](std::uint32_t i) { fill(changed_blocks_[i], *contacts_); });
}

// Copies all, since places behind the first unit of another size are others; slices of the old ones at once.
void ContactStore::move_units(Executor& executor, const std::vector<Contact>& found) {
    const bool held = is_held();
    if (!held) forget_new(executor);
    const std::span<const Contact> olds = all();
    std::size_t size = olds.size();
    maybe_new_.clear();
    for (const Unit& unit : units_) {
        size = size + unit.found.size() - unit.old.size();
        maybe_new_.push_back({unit.to, unit.to + unit.found.size()});
    }
    next_->resize(size);
    blocks_.resize((size + block_size - 1) / block_size);
    const std::size_t count = olds.size() / contacts_at_once + 1;
    copied_.assign(count, {0, 0});
    executor.each(count, 1, [&](std::uint32_t slice) {
        std::size_t from = slice * contacts_at_once;
        const std::size_t end = std::min(olds.size(), from + contacts_at_once);
        auto unit = std::ranges::lower_bound(units_, from, {}, [](const Unit& one) { return one.old.begin; });
        const auto last = slice + 1 == count ? units_.end()
                                             : std::ranges::lower_bound(units_, end, {},
                                                                        [](const Unit& one) { return one.old.begin; });
        Contact* to = next_->data() + from;
        if (unit != units_.begin()) {
            const Unit& before = unit[-1];
            from = std::max(from, before.old.end);
            to = next_->data() + (before.to + before.found.size() + (from - before.old.end));
        }
        const Contact* const first = to;
        const auto keep = [&](std::size_t until) {
            if (from >= until) return;
            Contact* const kept = std::exchange(to, std::copy_n(olds.data() + from, until - from, to));
            from = until;
            if (held) std::for_each(kept, to, [](Contact& contact) { contact.is_new = false; });
        };
        for (; unit != last; ++unit) {
            keep(unit->old.begin);
            to = std::copy_n(found.data() + unit->found.begin, unit->found.size(), to);
            from = unit->old.end;
        }
        keep(end);
        // While they are in the cache; those that slices share come after all.
        const Range own{static_cast<std::size_t>(first - next_->data()), static_cast<std::size_t>(to - next_->data())};
        copied_[slice] = own;
        for (std::size_t block = (own.begin + block_size - 1) / block_size; (block + 1) * block_size <= own.end;
             ++block)
            fill(block, *next_);
    });
    contacts_.swap(next_);
    for (const Range& own : copied_)
        if (own.size() > 0)
            for (const std::size_t block : {own.begin / block_size, (own.end - 1) / block_size})
                fill(block, *contacts_);
}

// Nobody else holds the contacts.
void ContactStore::forget_new(Executor& executor) {
    const auto forget = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) (*contacts_)[i].is_new = false;
    };
    if (maybe_new_.size() == 1)
        executor.run(static_cast<std::uint32_t>(maybe_new_[0].size()), 4096,
                     [&](std::uint32_t begin, std::uint32_t end) {
                         forget(maybe_new_[0].begin + begin, maybe_new_[0].begin + end);
                     });
    else
        executor.each(maybe_new_.size(), 64, [&](std::uint32_t i) { forget(maybe_new_[i].begin, maybe_new_[i].end); });
}

void ContactStore::rest(Executor& executor) {
    if (sums_.fresh > 0 || !maybe_new_.empty()) {
        if (is_held()) {
            *next_ = *contacts_;
            contacts_.swap(next_);
        }
        forget_new(executor);
        maybe_new_.clear();
    }
    sums_.fresh = 0;
    lost_.clear();
}

void ContactStore::restore(Executor& executor, std::vector<Contact> contacts) {
    contacts_ = std::make_shared<std::vector<Contact>>(std::move(contacts));
    lost_.clear();
    fill_all(executor);
    sum_up();
    sums_.fresh = static_cast<std::uint64_t>(
        std::ranges::count_if(*contacts_, [](const Contact& c) { return c.is_new && !c.is_speculative(); }));
}

void ContactStore::fill_all(Executor& executor) {
    maybe_new_.assign(1, {0, contacts_->size()});
    blocks_.resize((contacts_->size() + block_size - 1) / block_size);
    executor.each(blocks_.size(), 16, [&](std::uint32_t block) { fill(block, *contacts_); });
}

void ContactStore::fill(std::size_t block, std::span<const Contact> contacts) {
    const std::size_t begin = block * block_size, end = std::min(contacts.size(), begin + block_size);
    Block& own = blocks_[block];
    own = {number_of_pair(contacts[begin]), {}};
    for (const Contact& contact : contacts.subspan(begin, end - begin)) {
        const bool touches = !contact.is_speculative();
        own.sums.add({0, std::uint64_t{!touches}, touches ? double(contact.ray_length) : 0, double(contact.depth)});
    }
}

void ContactStore::sum_up() {
    sums_ = {.fresh = sums_.fresh};
    for (const Block& block : blocks_) sums_.add(block.sums);
}

} // namespace raycontact
