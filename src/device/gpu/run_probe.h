// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

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

} // namespace raycontact::gpu
