// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// The contacts of a step in the targets' frames. They name their pair by its directed index (DirectedPair).
class LocalContacts {
public:
    void clear() { contacts_.clear(); }
    /// Adds contacts whose pair is an index of `directed`, which has the directed indices.
    void add(std::span<const kernels::LocalContact> found, std::span<const std::uint32_t> directed);
    /// By pair; those of one pair stay in the order in which they were added.
    void sort(std::size_t pair_count);
    std::span<const kernels::LocalContact> contacts() const { return contacts_; }

private:
    std::vector<kernels::LocalContact> contacts_, sorted_;
    std::vector<std::uint32_t> firsts_; ///< by number
};

} // namespace raycontact
