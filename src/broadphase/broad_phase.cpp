// SPDX-License-Identifier: Apache-2.0
#include "broadphase/broad_phase.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace raycontact {

namespace {

constexpr std::uint32_t at_once = 16; // nodes, or boxes
// An order serves until it costs this much more than when it was new.
constexpr double slower = 1.3;
// Where more boxes than this share have changed, to find all pairs takes less than to find theirs.
constexpr std::size_t few = 4;

} // namespace

std::span<const SlotPair> BroadPhase::find(Executor& executor, BoxTree& tree, const BroadPhaseInput& input) {
    if (tree.levels() == 0) return {};
    const Question asked{tree, input};
    run(executor, tree.level(0).size(), [&](Found& found, std::uint32_t node) { meet(found, asked, node); });
    std::uint64_t tests = 0;
    for (const Found& found : found_) tests += found.tests;
    if (std::exchange(sorts_when_found_, tree.sorts()) != tree.sorts()) tests_when_sorted_ = tests;
    if (double(tests) > slower * double(tests_when_sorted_)) tree.sort_next();
    sort(executor, tree.size());
    return sorted_;
}

void BroadPhase::update(Executor& executor, BoxTree& tree, const BroadPhaseInput& input,
                        std::span<const BodySlot> changed, OpenPairs& pairs) {
    if (changed.empty()) return;
    if (changed.size() > tree.size() / few) return pairs.set_all(executor, find(executor, tree, input));
    is_changed_.resize(tree.size(), 0);
    for (const BodySlot body : changed) is_changed_[body] = 1;
    const Question asked{tree, input};
    run(executor, changed.size(),
        [&](Found& found, std::uint32_t i) { query(found, asked, changed[i], tree.levels() - 1, 0); });
    sort(executor, tree.size());
    pairs.set_of(executor, changed, is_changed_, sorted_);
    for (const BodySlot body : changed) is_changed_[body] = 0;
}

// What work(found, i) finds, by some i in a row.
template <class Work>
void BroadPhase::run(Executor& executor, std::size_t count, Work&& work) {
    const std::size_t tasks = (count + at_once - 1) / at_once;
    if (found_.size() < tasks) found_.resize(tasks);
    executor.each(tasks, 1, [&](std::uint32_t task) {
        Found& found = found_[task];
        found.pairs.clear();
        found.tests = 0;
        const std::size_t end = std::min<std::size_t>(count, (task + std::size_t{1}) * at_once);
        for (std::size_t i = std::size_t{task} * at_once; i < end; ++i) work(found, static_cast<std::uint32_t>(i));
    });
    for (std::size_t task = tasks; task < found_.size(); ++task) found_[task] = {};
}

// A node of the lowest level meets itself and those behind it.
void BroadPhase::meet(Found& found, const Question& asked, std::uint32_t node) {
    BoxTree::Corner low, high;
    asked.tree.level(0)[node].bounds(low, high);
    if (asked.tree.levels() == 1)
        test(found, asked, node, node);
    else
        descend(found, asked, node, low, high, asked.tree.levels() - 1, 0);
}

void BroadPhase::descend(Found& found, const Question& asked, std::uint32_t node, const BoxTree::Corner& low,
                         const BoxTree::Corner& high, std::size_t level, std::uint32_t at) {
    ++found.tests;
    for (std::uint32_t lanes = asked.tree.level(level)[at].touching(low, high); lanes != 0; lanes &= lanes - 1) {
        const std::uint32_t child = width * at + static_cast<std::uint32_t>(std::countr_zero(lanes));
        const std::uint64_t end = (std::uint64_t{child} + 1) << (4 * (level - 1)); // of the nodes below it
        if (end <= node) continue;
        if (level == 1)
            test(found, asked, node, child);
        else
            descend(found, asked, node, low, high, level - 1, child);
    }
}

// The boxes of two nodes of the lowest level.
void BroadPhase::test(Found& found, const Question& asked, std::uint32_t node, std::uint32_t other) {
    const BoxTree& tree = asked.tree;
    const BoxTree::Node &own = tree.level(0)[node], &theirs = tree.level(0)[other];
    const std::size_t count = std::min<std::size_t>(width, tree.size() - std::size_t{width} * node);
    found.tests += count;
    for (std::uint32_t i = 0; i < count; ++i) {
        const BoxTree::Corner low{own.low[0][i], own.low[1][i], own.low[2][i]};
        const BoxTree::Corner high{own.high[0][i], own.high[1][i], own.high[2][i]};
        std::uint32_t lanes = theirs.touching(low, high);
        if (node == other) lanes &= ~((2u << i) - 1);
        const BodySlot a = tree.body(std::size_t{width} * node + i);
        for (; lanes != 0; lanes &= lanes - 1) {
            const BodySlot b =
                tree.body(std::size_t{width} * other + static_cast<std::uint32_t>(std::countr_zero(lanes)));
            if (asked.input.is_pair(a, b)) found.pairs.emplace_back(std::minmax(a, b));
        }
    }
}

// What a box that changed touches; of two that did, the lower finds the other.
void BroadPhase::query(Found& found, const Question& asked, BodySlot body, std::size_t level, std::uint32_t at) const {
    BoxTree::Corner low, high;
    BoxTree::round_out(asked.input.boxes[body], low, high);
    for (std::uint32_t lanes = asked.tree.level(level)[at].touching(low, high); lanes != 0; lanes &= lanes - 1) {
        const std::uint32_t child = width * at + static_cast<std::uint32_t>(std::countr_zero(lanes));
        if (level > 0) {
            query(found, asked, body, level - 1, child);
            continue;
        }
        const BodySlot other = asked.tree.body(child);
        if (other == body || (other < body && is_changed_[other] != 0)) continue;
        if (asked.input.is_pair(body, other)) found.pairs.emplace_back(std::minmax(body, other));
    }
}

void BroadPhase::sort(Executor& executor, std::size_t slots) {
    lists_.clear();
    for (const Found& found : found_) lists_.emplace_back(found.pairs);
    sorter_.run(executor, slots, lists_, sorted_);
}

void BroadPhase::trim() {
    *this = {};
}

} // namespace raycontact
