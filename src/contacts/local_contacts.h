// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// The contacts of a step in the targets' frames. They name their ordered pair by its number: 2 x pair + direction.
class LocalContacts {
public:
    void clear() { contacts_.clear(); }
    /// Adds contacts whose pair is a place in `numbers`.
    void add(std::span<const kernels::LocalContact> found, std::span<const std::uint32_t> numbers);
    /// By pair; those of one pair stay in the order in which they were added.
    void sort(std::size_t pair_count);
    std::span<const kernels::LocalContact> contacts() const { return contacts_; }

private:
    std::vector<kernels::LocalContact> contacts_, sorted_;
    std::vector<std::uint32_t> firsts_; ///< by number
};

} // namespace raycontact
