// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <algorithm>
#include <array>

namespace raycontact::gpu {

/// The kernels of gpu/scan.h, as run_scan() numbers them.
inline constexpr std::array scan_kernels = {"scan_at_once", "scan_blocks", "scan_sums", "scan_firsts"};

constexpr std::size_t scan_sums_bytes(std::size_t group_size) {
    return sizeof(kernels::ulong) * MOST_COLUMNS * group_size;
}

/// Queue::scan(). sums: scan_sums_bytes() of memory. group_size: SCAN_GROUP. launch(kernel, groups, count, arguments)
/// starts one of scan_kernels.
template <typename Launch>
kernels::uint run_scan(const ScanOf& scan, const Buffer& sums, std::size_t group_size, Launch launch) {
    const auto number = [](kernels::uint value) { return Argument{nullptr, value, true}; };
    const Argument columns = number(scan.columns), stride = number(scan.stride), at = number(scan.at),
                   room = number(scan.room), values{scan.values}, firsts{scan.firsts}, totals{scan.totals},
                   block_sums{&sums};
    if (scan.count.most <= SCAN_AT_ONCE) {
        launch(0, 1, scan.count, std::array{columns, stride, values, firsts, totals, at, room});
        return 1;
    }
    const std::size_t tile = group_size * SCAN_ITEMS,
                      blocks = std::min((scan.count.most + tile - 1) / tile, group_size); // a thread for each sum
    launch(1, blocks, scan.count, std::array{columns, stride, values, block_sums});
    launch(2, 1, scan.count,
           std::array{columns, number(static_cast<kernels::uint>(blocks)), block_sums, totals, at, room});
    launch(3, blocks, scan.count, std::array{values, block_sums, firsts});
    return 3;
}

} // namespace raycontact::gpu
