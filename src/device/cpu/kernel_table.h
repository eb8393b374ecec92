// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <array>
#include <string_view>
#include <utility>

namespace raycontact::cpu {

using Entry = void (*)(kernels::Range, kernels::uint, const Argument*);

/// Every kernel, compiled for one instruction set.
struct KernelTable {
    std::string_view instruction_set;
    std::array<Entry, static_cast<std::size_t>(KernelId::count)> entries;
};

/// The tables that this build has and this processor can run, the widest first. All give the same bits.
std::span<const KernelTable* const> usable_tables();

void* address_of(const Argument& argument);

template <typename Parameter>
Parameter unpack(const Argument& argument) {
    if constexpr (std::is_pointer_v<Parameter>)
        return static_cast<Parameter>(address_of(argument));
    else
        return argument.scalar;
}

template <auto kernel>
struct Unpacked;
template <typename... Parameters, void (*kernel)(kernels::Range, kernels::uint, Parameters...)>
struct Unpacked<kernel> {
    static void run(kernels::Range range, kernels::uint count, const Argument* arguments) {
        [&]<std::size_t... i>(std::index_sequence<i...>) {
            kernel(range, count, unpack<Parameters>(arguments[i])...);
        }
        (std::index_sequence_for<Parameters...>{});
    }
};

} // namespace raycontact::cpu
