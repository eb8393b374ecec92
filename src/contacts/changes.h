// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slot_pair.h"

#include <raycontact/contact.h>

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace raycontact {

/// What contacts are sorted by: the pair, then the key.
using ContactOrder = std::pair<SlotPair, std::uint64_t>;
inline ContactOrder order_of(const Contact& contact) {
    return {pair_of(contact), contact.key()};
}

/// Finds the contacts of a step that the last step did not have, and those that are gone. What touches is new where it
/// did not touch before.
class Changes {
public:
    /// A contact of the last step.
    struct Known {
        BodyId body_a, body_b;
        std::uint64_t key;
        ContactOrder order() const { return {{body_a.slot, body_b.slot}, key}; }
    };
    /// Sorted.
    std::span<const Known> previous() const { return previous_; }
    /// contacts: sorted; sets is_new.
    void mark(std::span<Contact> contacts);
    std::span<const LostContact> lost() const { return lost_; }
    /// Of those that touch.
    std::size_t new_count() const { return new_count_; }

private:
    std::vector<Known> previous_;
    std::vector<LostContact> lost_;
    std::vector<std::uint8_t> touched_; ///< by place in previous_
    std::size_t new_count_ = 0;
};

} // namespace raycontact
