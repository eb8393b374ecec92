// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

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

} // namespace raycontact::gpu
