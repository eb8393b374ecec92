// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>

#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

namespace raycontact {

/// What contacts are sorted by, in three words.
using ContactOrder = std::tuple<std::uint64_t, std::uint64_t, std::uint32_t>;
ContactOrder order_of(const LostContact& key);
ContactOrder order_of(const Contact& contact);

/// Finds the contacts of a step that the last step did not have, and those that are gone. What touches is new where it
/// did not touch before.
class Changes {
public:
    /// Of the last step, sorted.
    std::span<const LostContact> previous() const { return previous_; }
    /// contacts: sorted; sets is_new.
    void mark(std::span<Contact> contacts);
    std::span<const LostContact> lost() const { return lost_; }
    /// Of those that touch.
    std::size_t new_count() const { return new_count_; }

private:
    std::vector<LostContact> previous_, lost_;
    std::vector<std::uint8_t> touched_; ///< by place in previous_
    std::size_t new_count_ = 0;
};

} // namespace raycontact
