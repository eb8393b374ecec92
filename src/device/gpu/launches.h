// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <algorithm>
#include <array>
#include <type_traits>

namespace raycontact::gpu {

/// By KernelId; null: needs the host's memory, so that only the CPU runs it.
inline constexpr const char* kernel_names[] = {
#define RAYCONTACT_KERNEL(name) #name,
#define RAYCONTACT_CPU_KERNEL(name) nullptr,
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL
};
constexpr const char* name_of(KernelId id) {
    return kernel_names[static_cast<std::size_t>(id)];
}

/// By KernelId: it is left out where a device has no double.
inline constexpr bool is_in_double[] = {
#define RAYCONTACT_KERNEL(name) false,
#define RAYCONTACT_CPU_KERNEL(name) false,
#define RAYCONTACT_DOUBLE_KERNEL(name) true,
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL
};

// The arguments of a launch over no items.
template <typename Function>
struct Nothing;
template <typename... Parameters>
struct Nothing<void (*)(kernels::Range, kernels::uint, Parameters...)> {
    static constexpr Argument arguments[] = {{nullptr, 0, !std::is_pointer_v<Parameters>}...};
};

/// Launches every kernel that the device has over no items. Some drivers compile or load a kernel at its first launch;
/// that must not happen during a step.
template <typename Has>
void launch_all(Queue& queue, Has has) {
#define RAYCONTACT_KERNEL(name)                                                                                        \
    if (has(KernelId::name)) queue.launch(KernelId::name, 0, Nothing<Prototype<KernelId::name>::type>::arguments);
#define RAYCONTACT_CPU_KERNEL(name)
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL
    for (const std::size_t most : {std::size_t{0}, std::size_t{SCAN_AT_ONCE} + 1})
        queue.scan({.count = {nullptr, 0, most}, .columns = 0});
    queue.finish();
}

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
                   before = number(scan.before), room = number(scan.room), values{scan.values}, firsts{scan.firsts},
                   totals{scan.totals}, block_sums{&sums};
    if (scan.count.most <= SCAN_AT_ONCE) {
        launch(0, 1, scan.count, std::array{columns, stride, values, firsts, totals, at, room, before});
        return 1;
    }
    const std::size_t tile = group_size * SCAN_ITEMS,
                      blocks = std::min((scan.count.most + tile - 1) / tile, group_size); // a thread for each sum
    launch(1, blocks, scan.count, std::array{columns, stride, values, block_sums});
    launch(2, 1, scan.count,
           std::array{columns, number(static_cast<kernels::uint>(blocks)), block_sums, totals, at, room, before});
    launch(3, blocks, scan.count, std::array{values, block_sums, firsts});
    return 3;
}

} // namespace raycontact::gpu
