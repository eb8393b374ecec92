// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/update.h"

namespace raycontact {

/// The bodies and the open pairs as the device keeps them. A step sends only changes; the device then places every
/// pair, in double. If it has no double, the host places them with the same text.
class DevicePairs {
public:
    /// next: also where they will be at the next step.
    void place(const Update& update, bool next = false);
    void clear() { *this = {}; }
    /// Of the last place().
    std::size_t count() const { return open_; }
    std::uint64_t bytes() const { return open_ * (sizeof(kernels::PairBodies) + 2 * sizeof(kernels::DirectedPair)); }

    /// At 2 x slot of a pair, + 1 for vertices of the second body against the first; some slots have no pair.
    const Array<kernels::DirectedPair>& placed() const { return now_.placed; }
    /// The same at the next step; empty unless asked for.
    const Array<kernels::DirectedPair>& next_placed() const { return next_.placed; }

private:
    /// The pairs at one time.
    struct Placing {
        SlotChanges::Seen seen = 0;
        std::vector<kernels::BodyPlace> sent, moved;    ///< by body; of those that moved
        std::vector<kernels::DirectedPair> host_placed; ///< of a device without double
        Array<kernels::BodyPlace> device_bodies, device_moved;
        Array<kernels::DirectedPair> placed;
    };
    void list_moved(const Update& update, Pose PlacedBody::*pose, Placing& at);
    void place(const Update& update, Placing& at);
    void place_on_host(const Update& update, Placing& at);

    std::size_t open_ = 0;
    SlotChanges::Seen seen_ = 0;
    std::vector<kernels::PairChange> changed_;
    Placing now_, next_;
    Array<kernels::PairBodies> device_pairs_;
    Array<kernels::PairChange> device_changed_;
};

} // namespace raycontact
