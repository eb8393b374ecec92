// SPDX-License-Identifier: Apache-2.0
#include "broadphase/broad_phase.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace raycontact {

namespace {

constexpr float unbounded = std::numeric_limits<float>::infinity();
constexpr std::uint32_t nodes_at_once = 16;
// An order serves until it costs this much more than when it was new.
constexpr double slower = 1.3;

float below(double x) {
    const auto rounded = static_cast<float>(x);
    return double(rounded) <= x ? rounded : std::nextafter(rounded, -unbounded);
}
float above(double x) {
    return -below(-x);
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

void BroadPhase::find(Executor& executor, std::span<const WorldBox> boxes, std::vector<SlotPair>& pairs) {
    pairs.clear();
    if (boxes.size() < 2) return;
    const bool sorts = order_.size() != boxes.size() || double(tests_) > slower * double(tests_when_sorted_);
    if (sorts) sort_boxes(boxes);
    fill_tree(executor, boxes);
    const auto nodes = static_cast<std::uint32_t>(levels_.front().size());
    const std::uint32_t tasks = (nodes + nodes_at_once - 1) / nodes_at_once;
    if (found_.size() < tasks) found_.resize(tasks);
    executor.each(tasks, 1, [&](std::uint32_t task) {
        Found& found = found_[task];
        found.pairs.clear();
        found.tests = 0;
        const std::uint32_t end = std::min(nodes, (task + 1) * nodes_at_once);
        for (std::uint32_t node = task * nodes_at_once; node < end; ++node) meet(found, boxes, node);
    });
    for (std::size_t task = tasks; task < found_.size(); ++task) found_[task] = {};
    tests_ = 0;
    for (const Found& found : found_) tests_ += found.tests;
    if (sorts) tests_when_sorted_ = tests_;
    gather(executor, boxes, pairs);
}

void BroadPhase::sort_boxes(std::span<const WorldBox> boxes) {
    Box world = boxes[0];
    for (const WorldBox& box : boxes) world.add(box);
    const Vec3 size = world.high - world.low;
    const double longest = std::max({size.x, size.y, size.z});
    const double scale = longest > 0 ? 2097151 / longest : 0;
    keys_.clear();
    for (std::uint32_t i = 0; i < boxes.size(); ++i)
        keys_.emplace_back(place_on_curve(boxes[i].middle(), world, scale), i);
    std::sort(keys_.begin(), keys_.end());
    order_.clear();
    for (const auto& [place, box] : keys_) order_.push_back(box);
}

void BroadPhase::fill_tree(Executor& executor, std::span<const WorldBox> boxes) {
    std::size_t count = boxes.size(), level = 0;
    do {
        const std::size_t children = count;
        count = (count + width - 1) / width;
        if (levels_.size() == level) levels_.emplace_back();
        std::vector<Node>& nodes = levels_[level];
        nodes.resize(count);
        executor.each(count, 64, [&, level, children](std::uint32_t i) {
            Node& node = nodes[i];
            for (std::uint32_t k = 0; k < width; ++k) {
                const std::size_t child = std::size_t{width} * i + k;
                Corner low{unbounded, unbounded, unbounded}, high{-unbounded, -unbounded, -unbounded};
                if (child < children && level == 0) {
                    const WorldBox& box = boxes[order_[child]];
                    low = {below(box.low.x), below(box.low.y), below(box.low.z)};
                    high = {above(box.high.x), above(box.high.y), above(box.high.z)};
                } else if (child < children) {
                    bounds_of(levels_[level - 1][child], low, high);
                }
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    node.low[axis][k] = low[axis];
                    node.high[axis][k] = high[axis];
                }
            }
        });
        ++level;
    } while (count > 1);
    levels_.resize(level);
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
void BroadPhase::meet(Found& found, std::span<const WorldBox> boxes, std::uint32_t node) const {
    Corner low, high;
    bounds_of(levels_.front()[node], low, high);
    if (levels_.size() == 1)
        test(found, boxes, node, node);
    else
        descend(found, boxes, node, low, high, levels_.size() - 1, 0);
}

void BroadPhase::descend(Found& found, std::span<const WorldBox> boxes, std::uint32_t node, const Corner& low,
                         const Corner& high, std::size_t level, std::uint32_t at) const {
    ++found.tests;
    for (std::uint32_t lanes = touching(levels_[level][at], low, high); lanes != 0; lanes &= lanes - 1) {
        const std::uint32_t child = width * at + static_cast<std::uint32_t>(std::countr_zero(lanes));
        const std::uint64_t end = (std::uint64_t{child} + 1) << (4 * (level - 1)); // of the nodes below it
        if (end <= node) continue;
        if (level == 1)
            test(found, boxes, node, child);
        else
            descend(found, boxes, node, low, high, level - 1, child);
    }
}

// The boxes of two nodes of the lowest level.
void BroadPhase::test(Found& found, std::span<const WorldBox> boxes, std::uint32_t node, std::uint32_t other) const {
    const Node &own = levels_.front()[node], &theirs = levels_.front()[other];
    const std::size_t count = std::min<std::size_t>(width, boxes.size() - std::size_t{width} * node);
    found.tests += count;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Corner low{own.low[0][i], own.low[1][i], own.low[2][i]};
        const Corner high{own.high[0][i], own.high[1][i], own.high[2][i]};
        std::uint32_t lanes = touching(theirs, low, high);
        if (node == other) lanes &= ~((2u << i) - 1);
        const WorldBox& a = boxes[order_[width * node + i]];
        for (; lanes != 0; lanes &= lanes - 1) {
            const auto k = static_cast<std::uint32_t>(std::countr_zero(lanes));
            const WorldBox& b = boxes[order_[width * other + k]];
            if (a.touches(b)) found.pairs.emplace_back(std::min(a.body, b.body), std::max(a.body, b.body));
        }
    }
}

// Sorted by the first body, each body's by the second.
void BroadPhase::gather(Executor& executor, std::span<const WorldBox> boxes, std::vector<SlotPair>& pairs) {
    const BodySlot last = std::ranges::max_element(boxes, {}, &WorldBox::body)->body;
    firsts_.assign(std::size_t{last} + 2, 0);
    for (const Found& found : found_)
        for (const SlotPair& pair : found.pairs) ++firsts_[pair.first + std::size_t{1}];
    std::partial_sum(firsts_.begin(), firsts_.end(), firsts_.begin());
    pairs.resize(firsts_.back());
    for (const Found& found : found_)
        for (const SlotPair& pair : found.pairs) pairs[firsts_[pair.first]++] = pair;
    // Now each counts to its end.
    executor.each(std::size_t{last} + 1, 1024, [&](std::uint32_t body) {
        const std::size_t begin = body == 0 ? 0 : firsts_[body - std::size_t{1}];
        std::sort(pairs.begin() + std::ptrdiff_t(begin), pairs.begin() + std::ptrdiff_t(firsts_[body]));
    });
}

void BroadPhase::trim() {
    *this = {};
}

} // namespace raycontact
