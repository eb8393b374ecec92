// SPDX-License-Identifier: Apache-2.0
#include "pairs/device_pairs.h"

#include "device/launch.h"

#include <algorithm>
#include <array>
#include <bit>

namespace raycontact {

namespace {

// Bits, not values: 0 and -0 are one place, but not one contact.
using PlaceBits = std::array<std::uint64_t, 13>;

} // namespace

void DevicePairs::list_moved(const Update& update, Pose PlacedBody::*pose, Placing& at) {
    at.moved.clear();
    at.sent.resize(update.bodies.size(), {{}, {}, NONE, 0}); // no shape: this body was never sent
    update.moved.each_since(at.seen, update.bodies.size(), [&](BodySlot i) {
        if (update.bodies[i].shape == nullptr) return;
        const kernels::BodyPlace now = place_of(update.bodies[i].*pose, update.bodies[i].shape_index, i);
        if (std::bit_cast<PlaceBits>(now) == std::bit_cast<PlaceBits>(at.sent[i])) return;
        at.moved.push_back(at.sent[i] = now);
    });
}

void DevicePairs::place(const Update& update, bool next) {
    changed_.clear();
    const std::span<const kernels::PairBodies> pairs = update.open.bodies();
    const SlotChanges& changes = update.open.changes();
    if (seen_ != changes.now() && !changes.is_next(seen_)) clear();
    open_ = update.open.count();
    changes.each_since(seen_, pairs.size(), [&](std::uint32_t slot) { changed_.push_back({slot, pairs[slot]}); });
    device_pairs_.extend(update.device, pairs.size());
    device_changed_.write(update.device, changed_);
    list_moved(update, &PlacedBody::centred, now_);
    place(update, now_);
    changed_.clear(); // both have the same pairs
    if (!next) return;
    list_moved(update, &PlacedBody::next, next_);
    place(update, next_);
}

void DevicePairs::place(const Update& update, Placing& at) {
    const std::span<const kernels::PairBodies> pairs = update.open.bodies();
    at.placed.resize(update.device, 2 * pairs.size());
    if (!update.device.traits().has_double) return place_on_host(update, at);
    at.device_bodies.extend(update.device, at.sent.size());
    at.device_moved.write(update.device, at.moved);
    launch<KernelId::apply_changes>(update.device, at.moved.size() + changed_.size(),
                                    static_cast<kernels::uint>(at.moved.size()), at.device_moved, device_changed_,
                                    at.device_bodies, device_pairs_);
    launch<KernelId::place_pairs>(update.device, pairs.size(), device_pairs_, at.device_bodies, update.arrays().headers,
                                  at.placed);
}

void DevicePairs::place_on_host(const Update& update, Placing& at) {
    const std::span<const kernels::PairBodies> pairs = update.open.bodies();
    const auto count = static_cast<kernels::uint>(pairs.size());
    at.host_placed.resize(2 * pairs.size());
    update.executor.run(count, 256, [&](kernels::uint begin, kernels::uint end) {
        kernels::prototype::place_pairs({begin, end}, count, pairs.data(), at.sent.data(),
                                        update.shapes.headers().data(), at.host_placed.data());
    });
    at.placed.write(update.device, at.host_placed);
}

} // namespace raycontact
