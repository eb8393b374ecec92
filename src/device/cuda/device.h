// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <functional>

namespace raycontact::cuda {

struct Source;

/// Every device of the CUDA driver here; nothing is compiled for this. None where there is no driver.
std::vector<DeviceInfo> describe();

/// id: "cuda:i", the i-th of describe(). Throws InputError if the device does not exist or cannot run the kernels;
/// also, unless `inexact`, if its bits differ from the host's. Throws DeviceError if it fails. change: alters what is
/// compiled, for tests.
std::unique_ptr<Device> open(std::string_view id, bool inexact, const std::function<void(Source&)>& change = {});

} // namespace raycontact::cuda
