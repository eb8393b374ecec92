// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <functional>

namespace raycontact::opencl {

struct Source;

/// Every device of every OpenCL driver here, by what the drivers say; nothing is built for that.
std::vector<DeviceInfo> describe();

/// id: "opencl:i", the i-th of describe(), or "opencl:i/k", the k-th of its cores. Throws InputError for one that is
/// not there, or that cannot run the kernels; also, unless `inexact`, for one that gives other bits than the host.
/// change: what is built, for tests.
std::unique_ptr<Device> open(std::string_view id, bool inexact, const std::function<void(Source&)>& change = {});

} // namespace raycontact::opencl
