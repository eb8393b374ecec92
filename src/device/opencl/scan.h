// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"
#include "device/opencl/launcher.h"
#include "device/opencl/program.h"

namespace raycontact::opencl {

/// Queue::scan() with the kernels of device/gpu/scan.h.
class Scan {
public:
    Scan(const Program& program, cl_context context, cl_device_id device);

    /// Returns how many kernels that takes.
    kernels::uint run(Launcher& launcher, const ScanOf& scan);

private:
    Kernel at_once_, blocks_, sums_, firsts_;
    std::size_t group_size_ = 0; ///< as the kernel text sets it
    Memory block_sums_;
};

} // namespace raycontact::opencl
