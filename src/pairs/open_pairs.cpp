// SPDX-License-Identifier: Apache-2.0
#include "pairs/open_pairs.h"

#include "executor/copy_all.h"
#include "executor/row_slices.h"
#include "free_all.h"

#include <raycontact/error.h>

#include <algorithm>
#include <iterator>

namespace raycontact {

namespace {

constexpr std::size_t slice_size = 4096; // pairs
constexpr std::size_t bodies_at_once = 64;

} // namespace

void OpenPairs::set_gate(Admits admits) {
    admits_ = std::move(admits);
    refused_.clear();
    asks_all_ = true;
}

void OpenPairs::set_all(Executor& executor, std::span<const SlotPair> pairs, bool given) {
    all(executor);
    has_all_ = false; // until the list is whole again
    if (!given) pairs = admitted(all_.pairs, pairs, [](const SlotPair&) { return true; });
    asks_all_ = given; // nobody was asked about those
    if (given) refused_.clear();
    replace(executor, all_, pairs);
    has_all_ = true;
}

// Those of `now` that were open, and those that the gate lets in. What it refused and concerns these bodies is
// forgotten where it is not among them.
template <class Concerns>
std::span<const SlotPair> OpenPairs::admitted(std::span<const SlotPair> old, std::span<const SlotPair> now,
                                              Concerns&& concerns) {
    if (!admits_) return now;
    admitted_.clear();
    still_refused_.clear();
    std::ranges::copy_if(refused_, std::back_inserter(still_refused_),
                         [&](const SlotPair& pair) { return !concerns(pair); });
    const auto before = static_cast<std::ptrdiff_t>(still_refused_.size());
    auto open = old.begin();
    for (const SlotPair& pair : now) {
        while (open != old.end() && *open < pair) ++open;
        const bool was_open = open != old.end() && *open == pair;
        const bool comes_in = !is_refused(pair) && ((was_open && !asks_all_) || admits_(pair));
        (comes_in ? admitted_ : still_refused_).push_back(pair);
    }
    std::ranges::inplace_merge(still_refused_, still_refused_.begin() + before);
    refused_.swap(still_refused_);
    return admitted_;
}

void OpenPairs::set_of(Executor& executor, std::span<const BodySlot> bodies, std::span<const char> is_in,
                       std::span<const SlotPair> pairs) {
    list_of(executor, bodies, is_in, of_bodies_);
    const auto concerns = [&](const SlotPair& pair) { return is_in[pair.first] != 0 || is_in[pair.second] != 0; };
    if (replace(executor, of_bodies_, admitted(of_bodies_.pairs, pairs, concerns))) has_all_ = false;
}

void OpenPairs::apply(std::span<const SlotPair> opened, std::span<const SlotPair> closed) {
    if (!opened.empty() || !closed.empty()) has_all_ = false;
    for (const SlotPair& pair : closed)
        if (const std::uint32_t slot = slot_of(pair); slot != none) close(slot);
    if (!refused_.empty())
        std::erase_if(refused_, [&](const SlotPair& pair) { return std::ranges::binary_search(closed, pair); });
    const auto concerns = [](const SlotPair&) { return false; };
    for (const SlotPair& pair : admitted({}, opened, concerns)) open(pair);
}

void OpenPairs::close_all_of(BodySlot body) noexcept {
    while (body < heads_.size() && heads_[body] != none) {
        has_all_ = false;
        close(heads_[body] / 2);
    }
}

void OpenPairs::clear() noexcept {
    slots_.clear();
    refused_.clear();
    free_all(heads_, links_, closed_, all_, of_bodies_, slices_, found_, lists_, sorted_, sorter_, next_slots_);
    has_all_ = true;
}

bool OpenPairs::compact(Executor& executor) {
    if (!slots_.is_mostly_empty()) return false;
    const std::vector<SlotPair> pairs = all(executor).pairs, refused = refused_;
    const bool asks_all = asks_all_;
    clear();
    set_all(executor, pairs, true);
    refused_ = refused;
    asks_all_ = asks_all;
    return true;
}

const PairList& OpenPairs::all(Executor& executor) {
    if (has_all_) return all_;
    find(
        executor, heads_.size(), [](std::size_t i) { return static_cast<BodySlot>(i); }, [](BodySlot) { return true; });
    list_found(executor, all_);
    has_all_ = true;
    return all_;
}

void OpenPairs::list_of(Executor& executor, const SlotChanges& bodies, PairList& list) {
    const auto is_in = [&](BodySlot body) { return bodies.is_marked(body); };
    find(
        executor, bodies.list().size(), [&](std::size_t i) { return bodies.list()[i]; }, is_in);
    for (const std::uint32_t slot : slots_.changes().list()) {
        if (!slots_.is_open(slot)) continue;
        const SlotPair pair = slots_[slot];
        if (!is_in(pair.first) && !is_in(pair.second)) found_.back().push_back({pair, slot});
    }
    list_found(executor, list);
}

void OpenPairs::list_of(Executor& executor, std::span<const BodySlot> bodies, std::span<const char> is_in,
                        PairList& list) {
    find(
        executor, bodies.size(), [&](std::size_t i) { return bodies[i]; },
        [&](BodySlot body) { return is_in[body] != 0; });
    list_found(executor, list);
}

std::span<const SlotPair> OpenPairs::closed() {
    std::ranges::sort(closed_);
    closed_.erase(std::unique(closed_.begin(), closed_.end()), closed_.end());
    return closed_;
}

std::size_t OpenPairs::count_kept() const {
    const std::span<const std::uint32_t> changed = slots_.changes().list();
    return slots_.count()
           - static_cast<std::size_t>(std::ranges::count_if(changed, [&](auto slot) { return slots_.is_open(slot); }));
}

void OpenPairs::step_done() noexcept {
    closed_.clear();
    slots_.step_done();
}

void OpenPairs::forget() noexcept {
    slots_.forget();
}

void OpenPairs::trim() {
    if (!has_all_) free_all(all_);
    free_all(of_bodies_, slices_, found_, lists_, sorted_, sorter_, next_slots_);
    std::vector<SlotPair> closed; // with room for all, so that close() cannot fail
    closed.reserve(closed_.size() + slots_.count());
    closed.assign(closed_.begin(), closed_.end());
    closed_.swap(closed);
}

std::uint32_t OpenPairs::open(const SlotPair& pair) {
    if (slots_.count() >= NONE / 2) throw InputError("more than 2^31 pairs in one step; give fewer");
    if (heads_.size() <= pair.second) heads_.resize(pair.second + std::size_t{1}, none);
    // So that close() cannot fail.
    if (const std::size_t room = closed_.size() + slots_.count() + 1; closed_.capacity() < room)
        closed_.reserve(2 * room);
    const std::uint32_t slot = slots_.open(pair);
    if (links_.size() < 2 * std::size_t{slots_.end()}) links_.resize(2 * std::size_t{slots_.end()});
    for (Edge edge = 2 * slot; edge < 2 * slot + 2; ++edge) {
        Edge& head = heads_[body_of(edge)];
        links_[edge] = {head, none};
        if (head != none) links_[head].previous = edge;
        head = edge;
    }
    return slot;
}

void OpenPairs::close(std::uint32_t slot) noexcept {
    closed_.push_back(slots_[slot]);
    unlink(2 * slot);
    unlink(2 * slot + 1);
    slots_.close(slot);
}

void OpenPairs::unlink(Edge edge) noexcept {
    const auto [next, previous] = links_[edge];
    if (next != none) links_[next].previous = previous;
    (previous != none ? links_[previous].next : heads_[body_of(edge)]) = next;
}

// None if the pair is not open. A body may have very many: both lists are walked at once, as far as the shorter one.
std::uint32_t OpenPairs::slot_of(const SlotPair& pair) const {
    if (pair.second >= heads_.size()) return none;
    Edge first = heads_[pair.first], second = heads_[pair.second];
    while (first != none && second != none) {
        if (slots_[first / 2] == pair) return first / 2;
        if (slots_[second / 2] == pair) return second / 2;
        first = links_[first].next;
        second = links_[second].next;
    }
    return none;
}

// The pairs of some bodies: those of two are found by the first.
template <class BodyAt, class IsIn>
void OpenPairs::find(Executor& executor, std::size_t count, BodyAt&& body_at, IsIn&& is_in) {
    const std::size_t tasks = (count + bodies_at_once - 1) / bodies_at_once;
    found_.resize(std::max(found_.size(), tasks + 1));
    for (std::size_t i = tasks; i < found_.size(); ++i) found_[i].clear();
    executor.each(tasks, 1, [&](std::uint32_t task) {
        std::vector<OpenPair>& found = found_[task];
        found.clear();
        for (std::size_t i = task * bodies_at_once; i < std::min(count, (task + 1) * bodies_at_once); ++i) {
            const BodySlot body = body_at(i);
            if (body >= heads_.size()) continue;
            for (Edge edge = heads_[body]; edge != none; edge = links_[edge].next) {
                const SlotPair pair = slots_[edge / 2];
                if (edge % 2 == 0 || !is_in(pair.first)) found.push_back({pair, edge / 2});
            }
        }
    });
}

void OpenPairs::list_found(Executor& executor, PairList& list) {
    lists_.assign(found_.begin(), found_.end());
    sorter_.run(executor, heads_.size(), lists_, sorted_);
    list.assign(executor, sorted_);
}

// `now` takes the place of the listed ones, in the list as well. Returns whether they were others.
bool OpenPairs::replace(Executor& executor, PairList& list, std::span<const SlotPair> now) {
    if (std::ranges::equal(list.pairs, now)) return false;
    const std::size_t count = RowSlices{now.size(), slice_size}.count();
    if (slices_.size() < count) slices_.resize(count);
    executor.each(count, 1, [&](std::uint32_t s) { compare(list, now, s); });
    const std::span<const Slice> slices = std::span(slices_).first(count);
    for (const Slice& slice : slices)
        for (const std::size_t old : slice.closed) close(list.slots[old]);
    next_slots_.resize(now.size());
    for (const Slice& slice : slices)
        for (const std::size_t i : slice.opened) next_slots_[i] = open(now[i]);
    executor.each(count, 1, [&](std::uint32_t s) {
        for (const Run& run : slices[s].kept)
            std::copy_n(list.slots.begin() + std::ptrdiff_t(run.old), run.count,
                        next_slots_.begin() + std::ptrdiff_t(run.now));
    });
    list.slots.swap(next_slots_);
    copy_all(executor, now, list.pairs);
    return true;
}

// A slice of `now`, and the old ones from its first pair up to that of the next slice.
void OpenPairs::compare(const PairList& old_list, std::span<const SlotPair> pairs, std::size_t s) {
    const std::span<const SlotPair> olds = old_list.pairs;
    Slice& slice = slices_[s];
    slice.kept.clear();
    slice.opened.clear();
    slice.closed.clear();
    std::size_t now = s * slice_size;
    const std::size_t end = std::min(pairs.size(), now + slice_size);
    const auto before = beside(olds, now, end, pairs.size(), [&](std::size_t i) { return pairs[i]; });
    auto old = static_cast<std::size_t>(before.data() - olds.data());
    const std::size_t old_end = old + before.size();
    while (now < end || old < old_end) {
        // Most pairs stay, in runs.
        const std::size_t most = std::min(end - now, old_end - old);
        std::size_t same = 0;
        while (same < most && pairs[now + same] == olds[old + same]) ++same;
        if (same > 0) slice.kept.push_back({old, now, same});
        now += same;
        old += same;
        if (old < old_end && (now == end || olds[old] < pairs[now]))
            slice.closed.push_back(old++);
        else if (now < end && (old == old_end || pairs[now] < olds[old]))
            slice.opened.push_back(now++);
    }
}

} // namespace raycontact
