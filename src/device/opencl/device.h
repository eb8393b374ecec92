// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <functional>

namespace raycontact::opencl {

struct Source;

/// Every device of every OpenCL driver here, as the drivers describe it; nothing is built for this.
std::vector<DeviceInfo> describe();

/// id: "opencl:i", the i-th of describe(), or "opencl:i/k", the k-th of its cores. Throws InputError if the device does
/// not exist or cannot run the kernels; also, unless `inexact`, if its bits differ from the host's. change: alters what
/// is built, for tests.
std::unique_ptr<Device> open(std::string_view id, bool inexact, const std::function<void(Source&)>& change = {});

} // namespace raycontact::opencl
