// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/cuda/driver.h"

#include <raycontact/device.h>

#include <vector>

namespace raycontact::cuda {

struct Listed {
    DeviceNumber device = 0;
    int architecture = 0; ///< 90 for a compute capability of 9.0
    int driver_major = 0; ///< the newest CUDA whose programs the driver takes
    DeviceInfo info;
};

/// The devices that the driver shows, in its order.
struct Devices {
    std::vector<Listed> found;
    std::string why_none; ///< empty if there are some
};
Devices devices();

/// The device that an id names ("cuda:0"). Throws InputError if there is none.
Listed find(std::string_view id);

} // namespace raycontact::cuda
