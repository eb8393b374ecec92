// SPDX-License-Identifier: Apache-2.0
#include "world_boxes.h"

#include "query/shape_pair.h"
#include "shape/shape_data.h"

#include <algorithm>

namespace raycontact {

void WorldBoxes::add_shape(const Shape& shape) {
    const ShapeData& data = shape.data();
    reach_known_ = reach_known_ && data.header.ray_reach <= reach_ && rounding_of(data) <= rounding_;
}

void WorldBoxes::remove_shape(const Shape& shape) {
    reach_known_ = reach_known_ && shape.data().header.ray_reach < reach_;
}

// The longest ray of all bodies.
void WorldBoxes::measure_reach(std::span<const PlacedBody> bodies) {
    float longest = 0;
    rounding_ = 0;
    for (const PlacedBody& body : bodies) {
        if (body.shape == nullptr) continue;
        longest = std::max(longest, body.shape->data().header.ray_reach);
        rounding_ = std::max(rounding_, rounding_of(body.shape->data()));
    }
    if (longest != reach_) seen_ = 0;
    reach_ = longest;
    reach_known_ = true;
}

double WorldBoxes::growth(const PlacedBody& body, bool looks_ahead, const Settings& settings) const {
    const double far = body.shape->has_inside() ? 0 : double(reach_);
    // What two boxes are wider by is at least the margin of their pair.
    const double share = body.margin >= 0 ? 1 : 0.5;
    const double near = looks_ahead ? share * speculative_margin(settings, body, body) : 0;
    return far + near;
}

Box WorldBoxes::box_of(const PlacedBody& body, const Pose* next, const Settings& settings) const {
    if (body.shape == nullptr) return no_box;
    const Box own{body.shape->box_min(), body.shape->box_max()};
    const double grow = growth(body, next != nullptr, settings);
    Box box = world_box(own, body.pose, grow);
    if (next != nullptr) box.add(world_box(own, *next, grow));
    return box;
}

void WorldBoxes::update(Executor& executor, std::span<const PlacedBody> bodies, std::span<const Pose> next,
                        const Settings& settings) {
    reach(bodies);
    try {
        remake(executor, bodies, next, settings);
    } catch (...) {
        seen_ = 0;
        tree_ = {};
        resize(boxes_.size());
        throw;
    }
}

void WorldBoxes::resize(std::size_t slots) {
    is_other_.resize(slots);
    boxes_.resize(slots, no_box); // last: where memory lacks, it tells that the others may be too short
}

void WorldBoxes::remake(Executor& executor, std::span<const PlacedBody> bodies, std::span<const Pose> next,
                        const Settings& settings) {
    // With room for bodies to come, which the tree takes as boxes that change.
    if (boxes_.size() < bodies.size() || boxes_.size() > 4 * bodies.size() + 1024)
        resize(bodies.size() + bodies.size() / 8);
    const auto make = [&](BodySlot slot) {
        Box box = no_box;
        if (slot < bodies.size()) box = box_of(bodies[slot], slot < next.size() ? &next[slot] : nullptr, settings);
        is_other_[slot] = box.low != boxes_[slot].low || box.high != boxes_[slot].high;
        boxes_[slot] = box;
    };
    others_.clear();
    const auto list = [&](BodySlot slot) {
        if (is_other_[slot] != 0) others_.push_back(slot);
    };
    if (moved_.each_since(seen_, executor, boxes_.size(), make)) {
        for (BodySlot slot = 0; slot < boxes_.size(); ++slot) list(slot);
    } else {
        for (const BodySlot slot : moved_.list())
            if (slot < boxes_.size()) list(slot);
    }
    tree_.update(executor, boxes_, others_);
    moved_.step_done();
}

} // namespace raycontact
