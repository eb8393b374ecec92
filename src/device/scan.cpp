// SPDX-License-Identifier: Apache-2.0
#include "device/scan.h"

#include <stdexcept>

namespace raycontact {

kernels::uint Scan::run(Device& device, const Array<kernels::uint>& values, Array<kernels::uint>& firsts) {
    const auto count = static_cast<kernels::uint>(values.size());
    if (count == 0) return 0;
    const kernels::uint blocks = (count - 1) / SCAN_BLOCK + 1;
    firsts.resize(device, count);
    sums_.resize(device, blocks + 1);
    launch<KernelId::scan_sums>(device, blocks, count, values, sums_);
    launch<KernelId::scan_offsets>(device, 1, blocks, sums_);
    launch<KernelId::scan_write>(device, blocks, count, values, sums_, firsts);
    const kernels::uint total = sums_.read_one(device, blocks);
    if (total == NONE) throw std::length_error("more than 2^32 items in one step; give it fewer pairs");
    return total;
}

} // namespace raycontact
