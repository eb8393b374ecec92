// SPDX-License-Identifier: Apache-2.0
#include "box_changes.h"

#include <array>
#include <bit>

namespace raycontact {

namespace {

using ExtentBits = std::array<std::uint64_t, 8>;

// As world_box() has them.
kernels::BodyExtent extent_of(const PlacedBody& body, double growth, const BroadPhaseInput::Filter& filter,
                              BodySlot slot) {
    const Box own{body.shape->box_min(), body.shape->box_max()};
    const Vec3 middle = own.middle(), half = 0.5 * (own.high - own.low) + Vec3{growth, growth, growth};
    return {{middle.x, middle.y, middle.z},
            {half.x, half.y, half.z},
            filter.groups,
            filter.mask,
            filter.is_static ? IS_THERE | IS_STATIC : IS_THERE,
            slot};
}

} // namespace

DeviceBroadPhase::Changes BoxChanges::list(Executor& executor, std::span<const PlacedBody> bodies,
                                           std::span<const Pose> next, std::span<const BroadPhaseInput::Filter> filters,
                                           WorldBoxes& world, const Settings& settings, std::size_t known) {
    // With room for bodies to come.
    std::size_t slots = extents_.size();
    if (slots < bodies.size() || slots > 4 * bodies.size() + 1024) slots = bodies.size() + bodies.size() / 8;
    if (known != slots || slots != extents_.size()) {
        forget();
        extents_.assign(slots, {{}, {}, 0, 0, 0, NONE}); // of no slot: as none was told
    }
    const float reach = world.reach(bodies);
    if (reach != reach_) forget();
    reach_ = reach;

    const std::size_t places = next.empty() ? 1 : 2;
    const auto list_body = [&](std::uint32_t i) {
        const BodySlot slot = listed_[i];
        kernels::BodyExtent extent{{}, {}, 0, 0, 0, slot};
        places_[places * i] = {{}, {}, 0, slot};
        if (slot < bodies.size() && bodies[slot].shape != nullptr) {
            const PlacedBody& body = bodies[slot];
            extent = extent_of(body, world.growth(body, !next.empty(), settings), filters[slot], slot);
            places_[places * i] = place_of(body.pose, 0, slot);
            if (!next.empty()) places_[places * i + 1] = place_of(next[slot], 0, slot);
        }
        is_other_[i] = std::bit_cast<ExtentBits>(extent) != std::bit_cast<ExtentBits>(extents_[slot]);
        extents_[slot] = extent;
    };
    try {
        listed_.clear();
        moved_.each_since(seen_, slots, [&](BodySlot slot) { listed_.push_back(slot); });
        places_.resize(places * listed_.size());
        is_other_.resize(listed_.size());
        executor.each(listed_.size(), 512, list_body);
        others_.clear();
        for (std::size_t i = 0; i < listed_.size(); ++i)
            if (is_other_[i] != 0) others_.push_back(extents_[listed_[i]]);
    } catch (...) {
        extents_.clear();
        throw;
    }
    moved_.step_done();
    return {slots, places, others_, places_};
}

} // namespace raycontact
