// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contacts/local_contacts.h"

#include <raycontact/scene.h>

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// The contacts of the last step, in the targets' frames: of two bodies that have not moved since they are still true.
class LastContacts {
public:
    /// Takes over what `contacts` holds of a step with these pairs, which are sorted.
    void keep(std::span<const Pair> pairs, LocalContacts& contacts);
    void clear();
    /// Appends the contacts of some ordered pairs of `pairs`, numbered 2 x pair + direction and ascending, each by its
    /// place in `ordered`. All of them were pairs of the last step.
    void find(std::span<const Pair> pairs, std::span<const std::uint32_t> ordered,
              std::vector<kernels::LocalContact>& found) const;

    std::uint64_t bytes() const { return pairs_.size() * sizeof(Pair) + contacts_.size() * sizeof(contacts_[0]); }

private:
    std::vector<Pair> pairs_;
    std::vector<kernels::LocalContact> contacts_;
};

} // namespace raycontact
