// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"
#include "give_back.h"

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// The contacts of a step in the targets' frames, in the order of the pairs. They name their pair by its directed index
/// (DirectedBodies).
class LocalContacts {
public:
    /// found: each names its pair by an index of `directed`, which has the directed indices of some of pair_count
    /// pairs. Contacts of one pair keep their order.
    void set(std::span<const kernels::LocalContact> found, std::span<const std::uint32_t> directed,
             std::size_t pair_count);
    std::span<const kernels::LocalContact> contacts() const { return contacts_; }
    /// After a step: frees memory that it hardly used.
    void give_back() {
        raycontact::give_back(contacts_);
        raycontact::give_back(places_);
    }

private:
    std::vector<kernels::LocalContact> contacts_;
    std::vector<std::uint32_t> places_; ///< by directed index: of its next contact
};

} // namespace raycontact
