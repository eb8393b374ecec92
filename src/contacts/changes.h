// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>

#include <span>
#include <vector>

namespace raycontact {

/// Finds the contacts of a step that the last step did not have, and those that are gone.
class Changes {
public:
    /// contacts: sorted; sets is_new.
    void mark(std::span<Contact> contacts);
    std::span<const LostContact> lost() const { return lost_; }
    std::size_t new_count() const { return new_count_; }

private:
    std::vector<LostContact> previous_, lost_;
    std::size_t new_count_ = 0;
};

} // namespace raycontact
