// SPDX-License-Identifier: Apache-2.0
#include "broadphase/broad_phase.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

namespace raycontact {

namespace {

constexpr float unbounded = std::numeric_limits<float>::infinity();
constexpr std::uint32_t at_once = 16; // nodes, or boxes
constexpr std::uint64_t last_place = std::numeric_limits<std::uint64_t>::max();
// An order serves until it costs this much more than when it was new, or so many boxes for each there is have moved.
constexpr double slower = 1.3;
constexpr std::uint64_t moves = 4;
// Where more boxes than this share have moved, to find all pairs takes less than to find theirs.
constexpr std::size_t few = 4;

float below(double x) {
    const auto rounded = static_cast<float>(x);
    return double(rounded) <= x ? rounded : std::nextafter(rounded, -unbounded);
}
float above(double x) {
    return -below(-x);
}

template <class Corner>
void round_out(const Box& box, Corner& low, Corner& high) {
    low = {below(box.low.x), below(box.low.y), below(box.low.z)};
    high = {above(box.high.x), above(box.high.y), above(box.high.z)};
}

// Two zero bits before each of the lowest 21.
std::uint64_t spread(std::uint64_t x) {
    x &= 0x1fffff;
    x = (x | x << 32) & 0x001f00000000ffff;
    x = (x | x << 16) & 0x001f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
}

// A body's place on the curve (Morton 1966): the bits of its coordinates by turns.
std::uint64_t place_on_curve(const Vec3& p, const Box& world, double scale) {
    const Vec3 at = scale * (p - world.low);
    const auto step = [](double x) { return static_cast<std::uint64_t>(std::clamp(x, 0.0, 2097151.0)); };
    return spread(step(at.x)) << 2 | spread(step(at.y)) << 1 | spread(step(at.z));
}

} // namespace

void BroadPhase::find(Executor& executor, const BroadPhaseInput& input, std::vector<SlotPair>& pairs) {
    pairs.clear();
    const std::span<const Box> boxes = input.boxes;
    if (boxes.size() < 2) return order_.clear();
    const bool sorts = order_.size() != boxes.size() || double(tests_) > slower * double(tests_when_sorted_)
                       || changes_ > moves * boxes.size();
    if (sorts) sort_boxes(boxes);
    fill_tree(executor, boxes);
    const std::size_t nodes = levels_.front().size();
    run(executor, nodes, [&](Found& found, std::uint32_t node) { meet(found, input, node); });
    tests_ = 0;
    for (const Found& found : found_) tests_ += found.tests;
    if (sorts) tests_when_sorted_ = tests_;
    gather(executor, boxes.size(), pairs);
}

bool BroadPhase::update(Executor& executor, const BroadPhaseInput& input, std::span<const BodySlot> changed,
                        std::vector<SlotPair>& pairs) {
    if (changed.empty()) return false;
    const std::size_t slots = input.boxes.size();
    changes_ += changed.size();
    if (order_.size() != slots || changed.size() > slots / few || changes_ > moves * slots) {
        next_.swap(pairs);
        find(executor, input, pairs);
        return pairs != next_;
    }
    is_changed_.resize(slots, 0);
    for (const BodySlot body : changed) is_changed_[body] = 1;
    refit(input.boxes, changed);
    run(executor, changed.size(),
        [&](Found& found, std::uint32_t i) { query(found, input, changed[i], levels_.size() - 1, 0); });
    const bool differ = replace(pairs);
    for (const BodySlot body : changed) is_changed_[body] = 0;
    return differ;
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

void BroadPhase::sort_boxes(std::span<const Box> boxes) {
    Box world = no_box;
    for (const Box& box : boxes) world.add(box);
    const Vec3 size = world.high - world.low;
    const double longest = std::max({size.x, size.y, size.z});
    const double scale = longest > 0 ? 2097151 / longest : 0;
    keys_.clear();
    for (BodySlot i = 0; i < boxes.size(); ++i)
        keys_.emplace_back(boxes[i].touches(boxes[i]) ? place_on_curve(boxes[i].middle(), world, scale) : last_place,
                           i);
    std::sort(keys_.begin(), keys_.end());
    order_.clear();
    places_.resize(boxes.size());
    for (const auto& [place, body] : keys_) {
        places_[body] = static_cast<std::uint32_t>(order_.size());
        order_.push_back(body);
    }
    changes_ = 0;
}

void BroadPhase::Node::set(std::uint32_t lane, const Corner& from, const Corner& to) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis][lane] = from[axis];
        high[axis][lane] = to[axis];
    }
}

void BroadPhase::fill_tree(Executor& executor, std::span<const Box> boxes) {
    std::size_t count = boxes.size(), level = 0;
    do {
        const std::size_t children = count;
        count = (count + width - 1) / width;
        if (levels_.size() == level) levels_.emplace_back();
        std::vector<Node>& nodes = levels_[level];
        nodes.resize(count);
        executor.each(count, 64, [&, level, children](std::uint32_t i) {
            for (std::uint32_t k = 0; k < width; ++k) {
                const std::size_t child = std::size_t{width} * i + k;
                Corner low{unbounded, unbounded, unbounded}, high{-unbounded, -unbounded, -unbounded};
                if (child < children && level == 0)
                    round_out(boxes[order_[child]], low, high);
                else if (child < children)
                    bounds_of(levels_[level - 1][child], low, high);
                nodes[i].set(k, low, high);
            }
        });
        ++level;
    } while (count > 1);
    levels_.resize(level);
}

// The nodes above the boxes that changed.
void BroadPhase::refit(std::span<const Box> boxes, std::span<const BodySlot> changed) {
    touched_.clear();
    Corner low, high;
    for (const BodySlot body : changed) {
        round_out(boxes[body], low, high);
        levels_.front()[places_[body] / width].set(places_[body] % width, low, high);
        touched_.push_back(places_[body] / width);
    }
    for (std::size_t level = 1; level < levels_.size(); ++level) {
        std::ranges::sort(touched_);
        touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
        for (std::uint32_t& node : touched_) {
            bounds_of(levels_[level - 1][node], low, high);
            levels_[level][node / width].set(node % width, low, high);
            node /= width;
        }
    }
}

void BroadPhase::bounds_of(const Node& node, Corner& low, Corner& high) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = *std::min_element(node.low[axis], node.low[axis] + width);
        high[axis] = *std::max_element(node.high[axis], node.high[axis] + width);
    }
}

std::uint32_t BroadPhase::touching(const Node& node, const Corner& low, const Corner& high) {
    std::uint32_t hits[width];
    for (std::uint32_t k = 0; k < width; ++k)
        hits[k] = static_cast<std::uint32_t>(node.low[0][k] <= high[0])
                  & static_cast<std::uint32_t>(node.high[0][k] >= low[0])
                  & static_cast<std::uint32_t>(node.low[1][k] <= high[1])
                  & static_cast<std::uint32_t>(node.high[1][k] >= low[1])
                  & static_cast<std::uint32_t>(node.low[2][k] <= high[2])
                  & static_cast<std::uint32_t>(node.high[2][k] >= low[2]);
    std::uint32_t lanes = 0;
    for (std::uint32_t k = 0; k < width; ++k) lanes |= hits[k] << k;
    return lanes;
}

// A node of the lowest level meets itself and those behind it.
void BroadPhase::meet(Found& found, const BroadPhaseInput& input, std::uint32_t node) const {
    Corner low, high;
    bounds_of(levels_.front()[node], low, high);
    if (levels_.size() == 1)
        test(found, input, node, node);
    else
        descend(found, input, node, low, high, levels_.size() - 1, 0);
}

void BroadPhase::descend(Found& found, const BroadPhaseInput& input, std::uint32_t node, const Corner& low,
                         const Corner& high, std::size_t level, std::uint32_t at) const {
    ++found.tests;
    for (std::uint32_t lanes = touching(levels_[level][at], low, high); lanes != 0; lanes &= lanes - 1) {
        const std::uint32_t child = width * at + static_cast<std::uint32_t>(std::countr_zero(lanes));
        const std::uint64_t end = (std::uint64_t{child} + 1) << (4 * (level - 1)); // of the nodes below it
        if (end <= node) continue;
        if (level == 1)
            test(found, input, node, child);
        else
            descend(found, input, node, low, high, level - 1, child);
    }
}

// The boxes of two nodes of the lowest level.
void BroadPhase::test(Found& found, const BroadPhaseInput& input, std::uint32_t node, std::uint32_t other) const {
    const Node &own = levels_.front()[node], &theirs = levels_.front()[other];
    const std::size_t count = std::min<std::size_t>(width, order_.size() - std::size_t{width} * node);
    found.tests += count;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Corner low{own.low[0][i], own.low[1][i], own.low[2][i]};
        const Corner high{own.high[0][i], own.high[1][i], own.high[2][i]};
        std::uint32_t lanes = touching(theirs, low, high);
        if (node == other) lanes &= ~((2u << i) - 1);
        const BodySlot a = order_[width * node + i];
        for (; lanes != 0; lanes &= lanes - 1) {
            const BodySlot b = order_[width * other + static_cast<std::uint32_t>(std::countr_zero(lanes))];
            if (input.is_pair(a, b)) found.pairs.push_back(std::minmax(a, b));
        }
    }
}

// What a box that changed touches; of two that did, the lower finds the other.
void BroadPhase::query(Found& found, const BroadPhaseInput& input, BodySlot body, std::size_t level,
                       std::uint32_t at) const {
    Corner low, high;
    round_out(input.boxes[body], low, high);
    for (std::uint32_t lanes = touching(levels_[level][at], low, high); lanes != 0; lanes &= lanes - 1) {
        const std::uint32_t child = width * at + static_cast<std::uint32_t>(std::countr_zero(lanes));
        if (level > 0) {
            query(found, input, body, level - 1, child);
            continue;
        }
        const BodySlot other = order_[child];
        if (other == body || (other < body && is_changed_[other] != 0)) continue;
        if (input.is_pair(body, other)) found.pairs.push_back(std::minmax(body, other));
    }
}

// Sorted by the first body, each body's by the second.
void BroadPhase::gather(Executor& executor, std::size_t slots, std::vector<SlotPair>& pairs) {
    firsts_.assign(slots + 1, 0);
    for (const Found& found : found_)
        for (const SlotPair& pair : found.pairs) ++firsts_[pair.first + std::size_t{1}];
    std::partial_sum(firsts_.begin(), firsts_.end(), firsts_.begin());
    pairs.resize(firsts_.back());
    for (const Found& found : found_)
        for (const SlotPair& pair : found.pairs) pairs[firsts_[pair.first]++] = pair;
    // Now each counts to its end.
    executor.each(slots, 1024, [&](std::uint32_t body) {
        const std::size_t begin = body == 0 ? 0 : firsts_[body - std::size_t{1}];
        std::sort(pairs.begin() + std::ptrdiff_t(begin), pairs.begin() + std::ptrdiff_t(firsts_[body]));
    });
}

// Puts what was found in the place of all pairs of boxes that changed. Mostly it is the same.
bool BroadPhase::replace(std::vector<SlotPair>& pairs) {
    come_.clear();
    for (const Found& found : found_) come_.insert(come_.end(), found.pairs.begin(), found.pairs.end());
    std::ranges::sort(come_);
    gone_.clear();
    std::ranges::copy_if(pairs, std::back_inserter(gone_), [&](const SlotPair& pair) { return is_changed(pair); });
    if (come_ == gone_) return false;
    next_.clear();
    auto more = come_.begin();
    for (const SlotPair& pair : pairs) {
        if (is_changed(pair)) continue;
        for (; more != come_.end() && *more < pair; ++more) next_.push_back(*more);
        next_.push_back(pair);
    }
    next_.insert(next_.end(), more, come_.end());
    pairs.swap(next_);
    return true;
}

void BroadPhase::trim() {
    *this = {};
}

} // namespace raycontact
