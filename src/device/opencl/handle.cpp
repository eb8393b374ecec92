// SPDX-License-Identifier: Apache-2.0
#include "device/opencl/handle.h"

namespace raycontact::opencl {

namespace {

std::string status_text(cl_int status) {
    switch (status) {
    case CL_DEVICE_NOT_AVAILABLE:
        return "the device is not available";
    case CL_COMPILER_NOT_AVAILABLE:
        return "the driver has no compiler";
    case CL_MEM_OBJECT_ALLOCATION_FAILURE:
    case CL_INVALID_BUFFER_SIZE:
        return "out of device memory";
    case CL_OUT_OF_RESOURCES:
        return "out of resources, or a kernel failed";
    case CL_OUT_OF_HOST_MEMORY:
        return "out of host memory";
    case CL_BUILD_PROGRAM_FAILURE:
        return "the kernels do not build";
    default:
        return "it failed";
    }
}

} // namespace

void check(cl_int status, std::string_view what) {
    if (status != CL_SUCCESS)
        throw DeviceError(std::string(what) + ": " + status_text(status) + " (OpenCL status " + std::to_string(status)
                          + ")");
}

std::string text_of(cl_device_id device, cl_device_info what) {
    std::size_t size = 0;
    if (clGetDeviceInfo(device, what, 0, nullptr, &size) != CL_SUCCESS) return "";
    std::string text(size, '\0');
    if (clGetDeviceInfo(device, what, size, text.data(), nullptr) != CL_SUCCESS) return "";
    text.resize(text.find_last_not_of(std::string_view("\0 ", 2)) + 1);
    return text;
}

} // namespace raycontact::opencl
