// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/array.h"

namespace raycontact {

/// A table that kernels fill, and its scan on the device. Column 0 counts the results of each item; its prefix sums
/// tell where the results go. The other columns are statistics: only their sums count, and they need no read of their
/// own.
class Columns {
public:
    /// Makes room for `items` in each of `columns`. The contents are lost if the table must grow.
    void resize(Device& device, kernels::uint columns, std::size_t items);
    kernels::uint stride() const { return stride_; }
    const Array<kernels::uint>& values() const { return values_; }
    const Array<kernels::uint>& firsts() const { return firsts_; }

    /// Leaves the sums in totals[at]. room: the most results that the caller can store, with those `before`, which are
    /// others.
    void scan(Device& device, const Count& count, const Array<kernels::Totals>& totals, std::size_t at,
              std::size_t room, std::size_t before = 0) const;

private:
    Array<kernels::uint> values_, firsts_;
    kernels::uint columns_ = 0, stride_ = 0;
};

/// Numbers of items for later launches, from the scan that left totals[at]: the number of results, and the number of
/// items whose results are to be written. Both are 0 if the results had no room.
Count results_of(const Array<kernels::Totals>& totals, std::size_t at, std::size_t most);
Count items_of(const Array<kernels::Totals>& totals, std::size_t at, std::size_t most);

/// Throws InputError if 32 bits could not hold a sum.
void check_sums(std::span<const kernels::Totals> totals);

} // namespace raycontact
