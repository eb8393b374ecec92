// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/array.h"

#include <limits>
#include <stdexcept>
#include <type_traits>

namespace raycontact {

namespace detail {

// A pointer parameter takes an array of its element type, a scalar parameter a 32-bit unsigned value.
template <typename Parameter>
struct LaunchArgument;
template <>
struct LaunchArgument<kernels::uint> {
    static Argument make(kernels::uint value) { return {nullptr, value}; }
};
template <typename T>
struct LaunchArgument<T*> {
    static Argument make(const Array<std::remove_const_t<T>>& array) { return {array.buffer(), 0}; }
};

template <typename Function>
struct Launch;
template <typename... Parameters>
struct Launch<void (*)(kernels::Range, kernels::uint, Parameters...)> {
    template <typename... Given>
    static void run(Device& device, KernelId kernel, kernels::uint count, const Given&... given) {
        static_assert(sizeof...(Given) == sizeof...(Parameters), "a kernel argument is missing or in excess");
        if (count == 0) return;
        const Argument arguments[] = {LaunchArgument<std::remove_cv_t<strip<Parameters>>>::make(given)...};
        device.queue().launch(kernel, count, arguments);
    }

private:
    template <typename Parameter>
    using strip = std::remove_cv_t<Parameter>;
};

} // namespace detail

/// Runs a kernel over `count` work items. The host build of the kernel is the prototype: a missing argument, or an
/// array of the wrong element type, does not compile.
template <KernelId kernel, typename... Given>
void launch(Device& device, std::size_t count, const Given&... given) {
    if (count > std::numeric_limits<kernels::uint>::max())
        throw std::length_error("more than 2^32 work items in one launch; give a step fewer pairs");
    detail::Launch<typename Prototype<kernel>::type>::run(device, kernel, static_cast<kernels::uint>(count), given...);
}

} // namespace raycontact
