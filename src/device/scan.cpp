// SPDX-License-Identifier: Apache-2.0
#include "device/scan.h"

#include <stdexcept>

namespace raycontact {

// Of at least one value. Leaves the offsets of the blocks, and behind them the total, in sums_. Returns the number of
// blocks.
kernels::uint Scan::sum_up(Device& device, const Array<kernels::uint>& values) {
    const auto count = static_cast<kernels::uint>(values.size());
    const kernels::uint blocks = (count - 1) / SCAN_BLOCK + 1;
    sums_.resize(device, blocks + 1);
    launch<KernelId::scan_sums>(device, blocks, count, values, sums_);
    launch<KernelId::scan_offsets>(device, 1, blocks, sums_);
    return blocks;
}

kernels::uint Scan::read_total(Device& device, kernels::uint blocks) const {
    const kernels::uint total = sums_.read_one(device, blocks);
    if (total == NONE) throw std::length_error("more than 2^32 items in one step; give it fewer pairs");
    return total;
}

kernels::uint Scan::total(Device& device, const Array<kernels::uint>& values) {
    return values.size() == 0 ? 0 : read_total(device, sum_up(device, values));
}

kernels::uint Scan::run(Device& device, const Array<kernels::uint>& values, Array<kernels::uint>& firsts) {
    if (values.size() == 0) return 0;
    const kernels::uint blocks = sum_up(device, values);
    firsts.resize(device, values.size());
    launch<KernelId::scan_write>(device, blocks, static_cast<kernels::uint>(values.size()), values, sums_, firsts);
    return read_total(device, blocks);
}

} // namespace raycontact
