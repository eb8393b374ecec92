// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "free_all.h"

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
    /// Of the contacts that were marked.
    struct Sums {
        std::uint64_t fresh = 0, speculative = 0; ///< fresh: new ones that touch
        double ray_length = 0, depth_max = 0;     ///< metres; ray_length: of those that touch
        void add(const Sums& other);
    };
    const Sums& sums() const { return sums_; }
    /// All are as in the last step.
    void rest() {
        lost_.clear();
        sums_.fresh = 0;
    }
    std::span<const LostContact> lost() const { return lost_; }
    void trim() {
        previous_.shrink_to_fit();
        touched_.shrink_to_fit();
        lost_.shrink_to_fit();
        free_all(next_, next_touched_, slices_);
    }

private:
    /// What is found of some pairs in a row.
    struct Slice {
        std::vector<LostContact> lost;
        Sums sums;
    };
    void compare(std::size_t old, std::size_t old_end, std::span<Contact> contacts, std::size_t first, Slice& slice);

    std::vector<Known> previous_, next_;
    std::vector<std::uint8_t> touched_, next_touched_; ///< by place in previous_, next_
    std::vector<Slice> slices_;
    std::vector<LostContact> lost_;
    Sums sums_;
};

} // namespace raycontact
