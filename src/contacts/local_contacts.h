// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// The contacts that a step has found so far, in the targets' frames, in the order of the ordered pairs, which are
/// numbered 2 x pair + direction.
class LocalContacts {
public:
    void clear() { contacts_.clear(); }
    /// Adds contacts that name their pair by its place in `ordered`, in one or two ascending runs of those numbers; no
    /// pair may be in both, or have been added before. which: the pairs that `ordered` numbers; empty: all of them.
    void add(std::span<const kernels::LocalContact> found, std::span<const std::uint32_t> ordered,
             std::span<const std::uint32_t> which = {});
    std::span<const kernels::LocalContact> contacts() const { return contacts_; }

private:
    void merge(std::size_t first, std::size_t second);

    std::vector<kernels::LocalContact> contacts_, merged_;
};

} // namespace raycontact
