// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <CL/cl.h>

#include <string>
#include <vector>

namespace raycontact::device_test {

/// One device of an OpenCL platform, or a part of one.
struct OpenClInfo {
    cl_device_id id = nullptr;
    std::string name;
    cl_device_fp_config single = 0;

    /// What its float32 lacks to give our bits; empty when nothing.
    std::string lacks() const;
};

/// Every device of every platform, in the loader's order. Throws when no platform is installed.
std::vector<OpenClInfo> opencl_devices();
/// Parts of one compute unit each.
std::vector<OpenClInfo> opencl_parts(const OpenClInfo& device);

/// Builds a text and runs its kernels; as little as a test needs. Throws std::runtime_error naming the failed call, or
/// with the compiler's log.
std::unique_ptr<Device> open_opencl(const OpenClInfo& device, const std::string& text, const std::string& options);

/// The options that our bits need on this device.
std::string exact_options(const OpenClInfo& device);

} // namespace raycontact::device_test
