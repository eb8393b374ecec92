// SPDX-License-Identifier: Apache-2.0
#include "pairs/device_pairs.h"

#include "device/launch.h"

#include <raycontact/error.h>

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

void DevicePairs::list_changes(const Update& update) {
    changed_.clear();
    const auto keep = [](std::size_t, std::size_t, std::size_t) {};
    const auto change = [&](kernels::uint slot, const kernels::PairBodies& bodies) {
        if (slot == pairs_.size()) pairs_.emplace_back();
        pairs_[slot] = bodies;
        changed_.push_back({slot, bodies});
    };
    const auto open = [&](std::size_t i, kernels::uint slot) {
        change(slot, {update.pairs[i].first, update.pairs[i].second});
    };
    const bool changed = slots_.match(update.executor, update.pairs, keep, open, [&](kernels::uint slot) {
        change(slot, {NONE, NONE});
    });
    if (!changed) return;
    // A slot may be given again in the step in which it becomes free: it is sent once, as it is now.
    std::ranges::sort(changed_, {}, &kernels::PairChange::slot);
    const auto same_slot = [](const auto& a, const auto& b) { return a.slot == b.slot; };
    changed_.erase(std::unique(changed_.begin(), changed_.end(), same_slot), changed_.end());
    for (auto& [slot, bodies] : changed_) bodies = pairs_[slot];
    directed_.resize(2 * pairs_.size());
    update.executor.each(update.pairs.size(), 8192, [&](std::uint32_t i) {
        const std::size_t slot = slots_.slot(i);
        directed_[2 * slot] = 2 * i;
        directed_[2 * slot + 1] = 2 * i + 1;
    });
}

void DevicePairs::place(const Update& update, bool next) {
    if (update.pairs.size() >= NONE / 2) throw InputError("more than 2^31 pairs in one step; give fewer");
    if (is_mostly_empty(slots_.end(), update.pairs.size())) clear();
    list_changes(update);
    device_pairs_.extend(update.device, pairs_.size());
    device_changed_.write(update.device, changed_);
    list_moved(update, &PlacedBody::centred, now_);
    place(update, now_);
    changed_.clear(); // both have the same pairs
    if (!next) return;
    list_moved(update, &PlacedBody::next, next_);
    place(update, next_);
}

void DevicePairs::place(const Update& update, Placing& at) {
    at.placed.resize(update.device, 2 * pairs_.size());
    if (!update.device.traits().has_double) return place_on_host(update, at);
    at.device_bodies.extend(update.device, at.sent.size());
    at.device_moved.write(update.device, at.moved);
    launch<KernelId::apply_changes>(update.device, at.moved.size() + changed_.size(),
                                    static_cast<kernels::uint>(at.moved.size()), at.device_moved, device_changed_,
                                    at.device_bodies, device_pairs_);
    launch<KernelId::place_pairs>(update.device, pairs_.size(), device_pairs_, at.device_bodies,
                                  update.arrays().headers, at.placed);
}

void DevicePairs::place_on_host(const Update& update, Placing& at) {
    at.host_placed.resize(2 * pairs_.size());
    update.executor.run(static_cast<kernels::uint>(pairs_.size()), 256, [&](kernels::uint begin, kernels::uint end) {
        kernels::prototype::place_pairs({begin, end}, static_cast<kernels::uint>(pairs_.size()), pairs_.data(),
                                        at.sent.data(), update.shapes.headers().data(), at.host_placed.data());
    });
    at.placed.write(update.device, at.host_placed);
}

} // namespace raycontact
