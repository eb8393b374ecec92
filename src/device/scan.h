// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/array.h"

namespace raycontact {

/// A table that kernels fill, and its sums on the device: column 0 counts each item's results and tells where they go;
/// the other columns are only added up, so that statistics cost no read of their own.
class Columns {
public:
    /// Room for `items` in each of `columns`; lost when it must grow.
    void resize(Device& device, kernels::uint columns, std::size_t items);
    kernels::uint stride() const { return stride_; }
    const Array<kernels::uint>& values() const { return values_; }
    const Array<kernels::uint>& firsts() const { return firsts_; }

    /// totals[at]: what comes of it, results having `room`.
    void scan(Device& device, const Count& count, const Array<kernels::Totals>& totals, std::size_t at,
              std::size_t room) const;

private:
    Array<kernels::uint> values_, firsts_;
    kernels::uint columns_ = 0, stride_ = 0;
};

/// As many items as there are results, or as have any that are to be written, of the scan that left totals[at].
Count results_of(const Array<kernels::Totals>& totals, std::size_t at, std::size_t most);
Count items_of(const Array<kernels::Totals>& totals, std::size_t at, std::size_t most);

/// Throws std::length_error where 32 bits could not hold a sum.
void check_sums(std::span<const kernels::Totals> totals);

} // namespace raycontact
