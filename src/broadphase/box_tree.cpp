// SPDX-License-Identifier: Apache-2.0
#include "broadphase/box_tree.h"

#include "place_on_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact {

namespace {

constexpr float unbounded = std::numeric_limits<float>::infinity();
constexpr std::uint64_t last_place = std::numeric_limits<std::uint64_t>::max();
// An order serves until so many boxes for each that there is have moved.
constexpr std::uint64_t moves = 16;
// Where more boxes than this share have changed, to fill the tree takes less than to follow them.
constexpr std::size_t few = 4;

// A box that reaches beyond all floats ends at the last one: else it would touch lanes without a box.
float below(double x) {
    const auto rounded = static_cast<float>(x);
    const float least = double(rounded) <= x ? rounded : std::nextafter(rounded, -unbounded);
    return std::max(least, std::numeric_limits<float>::lowest());
}
float above(double x) {
    return -below(-x);
}

} // namespace

void BoxTree::Node::set(std::uint32_t lane, const Corner& from, const Corner& to) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis][lane] = from[axis];
        high[axis][lane] = to[axis];
    }
}

void BoxTree::Node::bounds(Corner& from, Corner& to) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        from[axis] = *std::min_element(low[axis], low[axis] + width);
        to[axis] = *std::max_element(high[axis], high[axis] + width);
    }
}

std::uint32_t BoxTree::Node::touching(const Corner& from, const Corner& to) const {
    std::uint32_t hits[width];
    for (std::uint32_t k = 0; k < width; ++k)
        hits[k] = static_cast<std::uint32_t>(low[0][k] <= to[0]) & static_cast<std::uint32_t>(high[0][k] >= from[0])
                  & static_cast<std::uint32_t>(low[1][k] <= to[1]) & static_cast<std::uint32_t>(high[1][k] >= from[1])
                  & static_cast<std::uint32_t>(low[2][k] <= to[2]) & static_cast<std::uint32_t>(high[2][k] >= from[2]);
    std::uint32_t lanes = 0;
    for (std::uint32_t k = 0; k < width; ++k) lanes |= hits[k] << k;
    return lanes;
}

void BoxTree::round_out(const Box& box, Corner& low, Corner& high) {
    low = {below(box.low.x), below(box.low.y), below(box.low.z)};
    high = {above(box.high.x), above(box.high.y), above(box.high.z)};
}

void BoxTree::build(Executor& executor, std::span<const Box> boxes) {
    if (boxes.empty()) {
        *this = {};
        return;
    }
    if (sorts_next_ || order_.size() != boxes.size()) sort(boxes);
    fill(executor, boxes);
}

void BoxTree::update(Executor& executor, std::span<const Box> boxes, std::span<const BodySlot> changed) {
    changes_ += changed.size();
    sorts_next_ = sorts_next_ || changes_ > moves * boxes.size();
    if (sorts_next_ || order_.size() != boxes.size() || changed.size() > boxes.size() / few)
        build(executor, boxes);
    else
        refit(boxes, changed);
}

void BoxTree::sort(std::span<const Box> boxes) {
    Box world = no_box;
    for (const Box& box : boxes) world.add(box);
    const Vec3 size = world.high - world.low;
    const double longest = std::max({size.x, size.y, size.z});
    const double scale = longest > 0 ? 2097151 / longest : 0;
    keys_.clear();
    for (BodySlot i = 0; i < boxes.size(); ++i)
        keys_.emplace_back(
            boxes[i].touches(boxes[i]) ? place_on_curve(boxes[i].middle(), world.low, scale) : last_place, i);
    std::sort(keys_.begin(), keys_.end());
    order_.clear();
    places_.resize(boxes.size());
    for (const auto& [place, body] : keys_) {
        places_[body] = static_cast<std::uint32_t>(order_.size());
        order_.push_back(body);
    }
    changes_ = 0;
    sorts_next_ = false;
    ++sorts_;
}

void BoxTree::fill(Executor& executor, std::span<const Box> boxes) {
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
                    levels_[level - 1][child].bounds(low, high);
                nodes[i].set(k, low, high);
            }
        });
        ++level;
    } while (count > 1);
    levels_.resize(level);
}

// The nodes above the boxes that changed.
void BoxTree::refit(std::span<const Box> boxes, std::span<const BodySlot> changed) {
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
            levels_[level - 1][node].bounds(low, high);
            levels_[level][node / width].set(node % width, low, high);
            node /= width;
        }
    }
}

} // namespace raycontact
