// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"

#include <raycontact/contact.h>

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace raycontact {

/// What contacts are sorted by: the slots of the pair, in one number, then the key.
using ContactOrder = std::pair<std::uint64_t, std::uint64_t>;
inline ContactOrder order_of(BodyId a, BodyId b, std::uint64_t key) {
    return {std::uint64_t{a.slot} << 32 | b.slot, key};
}
inline ContactOrder order_of(const Contact& contact) {
    return order_of(contact.body_a, contact.body_b, contact.key());
}

/// Finds the contacts of a step that the last step did not have, and those that are gone. What touches is new where it
/// did not touch before.
class Changes {
public:
    /// A contact of the last step.
    struct Known {
        BodyId body_a, body_b;
        std::uint64_t key;
        ContactOrder order() const { return order_of(body_a, body_b, key); }
    };
    /// Sorted.
    std::span<const Known> previous() const { return previous_; }
    /// contacts: sorted; sets is_new.
    void mark(Executor& executor, std::span<Contact> contacts);
    /// All are as in the last step.
    void rest() {
        lost_.clear();
        new_count_ = 0;
    }
    std::span<const LostContact> lost() const { return lost_; }
    /// Of those that touch.
    std::size_t new_count() const { return new_count_; }
    void trim() {
        previous_.shrink_to_fit();
        lost_.shrink_to_fit();
        touched_.shrink_to_fit();
        slices_ = {};
    }

private:
    /// What some pairs in a row lost and got.
    struct Slice {
        std::vector<LostContact> lost;
        std::size_t new_count;
    };
    void compare(std::span<const Known> previous, std::span<Contact> contacts, Slice& slice) const;

    std::vector<Slice> slices_;
    std::vector<Known> previous_;
    std::vector<LostContact> lost_;
    std::vector<std::uint8_t> touched_; ///< by place in previous_
    std::size_t new_count_ = 0;
};

} // namespace raycontact
