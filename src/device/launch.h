// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/array.h"

#include <type_traits>

namespace raycontact {

namespace detail {

// A pointer parameter takes an array of its element type, a scalar parameter a 32-bit unsigned value.
template <typename Parameter>
struct LaunchArgument;
template <>
struct LaunchArgument<kernels::uint> {
    static Argument make(kernels::uint value) { return {nullptr, value, true}; }
};
template <typename T>
struct LaunchArgument<T*> {
    /// An empty array is null, whatever room it has.
    static Argument make(const Array<std::remove_const_t<T>>& array) {
        return {array.size() == 0 ? nullptr : array.buffer(), 0, false};
    }
};

template <typename Function>
struct Launch;
template <typename... Parameters>
struct Launch<void (*)(kernels::Range, kernels::uint, Parameters...)> {
    template <typename... Given>
    static void run(Device& device, KernelId kernel, const Count& count, const Given&... given) {
        static_assert(sizeof...(Given) == sizeof...(Parameters), "a kernel argument is missing or in excess");
        if (count.most == 0) return;
        const Argument arguments[] = {LaunchArgument<std::remove_cv_t<strip<Parameters>>>::make(given)...};
        device.queue().launch(kernel, count, arguments);
    }

private:
    template <typename Parameter>
    using strip = std::remove_cv_t<Parameter>;
};

} // namespace detail

/// Runs a kernel over `count` work items. The host build of the kernel is the prototype: a missing argument, or an
/// array of another element type, does not compile.
template <KernelId kernel, typename... Given>
void launch(Device& device, const Count& count, const Given&... given) {
    detail::Launch<typename Prototype<kernel>::type>::run(device, kernel, count, given...);
}

} // namespace raycontact
