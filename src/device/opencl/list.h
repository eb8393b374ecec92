// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/opencl/handle.h"

#include <raycontact/device.h>

#include <optional>
#include <vector>

namespace raycontact::opencl {

/// A device of some driver, or a part of one. Kept for the process: drivers count references to parts wrongly.
struct Listed {
    cl_device_id id = nullptr;
    DeviceInfo info;
    bool runs = false; ///< our kernels, perhaps with other bits
};

/// Every device of every driver, in the loader's order; none where there is no driver.
const std::vector<Listed>& devices();
/// The parts of devices()[index], one compute unit each; none if its driver gives none.
const std::vector<Listed>& parts(std::size_t index);

/// The device that an id names ("opencl:0", "opencl:0/1"). Throws InputError if there is none.
const Listed& find(std::string_view id);

} // namespace raycontact::opencl
