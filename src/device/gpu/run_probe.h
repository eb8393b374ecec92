// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <raycontact/error.h>

#include <functional>
#include <span>
#include <string>

namespace raycontact::gpu {

/// What a device was found to compute.
struct Probed {
    std::string differs;       ///< the first float operation whose bits are not the host's; empty: it is exact
    bool exact_double = false; ///< it can place pairs
    /// Refuses a device that claimed to be exact and is not.
    void judge(DeviceInfo& info) const;
};

/// Starts a kernel of gpu/probe.h, by its name.
using LaunchProbe = std::function<void(const char* kernel, kernels::uint count, std::span<const Argument> arguments)>;

/// Lets the device compute 65 536 of each operation that decides a contact, and compares them with the host's, bit for
/// bit. A driver's own claims are not enough: some contract or flush whatever the text and the options demand.
Probed run_probe(Device& device, bool has_double, const LaunchProbe& launch);

/// What make() made of a listed device, with its kernels launched once. Throws InputError if the device cannot be used:
/// with `inexact`, only if it does not even run the kernels; and DeviceError if it does not open.
template <class Make>
auto open(const DeviceInfo& listed, bool runs, bool inexact, Make&& make) {
    const auto refuse = [](const DeviceInfo& info) {
        throw InputError("device '" + info.id + "' (" + info.name + ") cannot be used: " + info.why_not);
    };
    if (!listed.usable && !(inexact && runs)) refuse(listed);
    decltype(make()) device;
    try {
        device = make();
        if (device->info().usable || inexact) device->launch_all();
    } catch (const std::runtime_error& error) {
        throw DeviceError("device '" + listed.id + "' (" + listed.name + ") did not open: " + error.what());
    }
    if (!device->info().usable && !inexact) refuse(device->info());
    return device;
}

} // namespace raycontact::gpu
