// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <CL/cl.h>

#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

namespace raycontact::opencl {

inline std::string status_text(cl_int status) {
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

/// Throws DeviceError that names what failed, and how.
inline void check(cl_int status, std::string_view what) {
    if (status != CL_SUCCESS)
        throw DeviceError(std::string(what) + ": " + status_text(status) + " (OpenCL status " + std::to_string(status)
                          + ")");
}

template <auto release>
struct Release {
    template <typename T>
    void operator()(T* object) const {
        release(object);
    }
};
template <typename T, auto release>
using Owned = std::unique_ptr<std::remove_pointer_t<T>, Release<release>>;

using Context = Owned<cl_context, clReleaseContext>;
using CommandQueue = Owned<cl_command_queue, clReleaseCommandQueue>;
using Memory = Owned<cl_mem, clReleaseMemObject>;
using BuiltProgram = Owned<cl_program, clReleaseProgram>;
using Kernel = Owned<cl_kernel, clReleaseKernel>;
using Event = Owned<cl_event, clReleaseEvent>;

/// A property of a device; empty or zero if it does not know that property.
inline std::string text_of(cl_device_id device, cl_device_info what) {
    std::size_t size = 0;
    if (clGetDeviceInfo(device, what, 0, nullptr, &size) != CL_SUCCESS) return "";
    std::string text(size, '\0');
    if (clGetDeviceInfo(device, what, size, text.data(), nullptr) != CL_SUCCESS) return "";
    text.resize(text.find_last_not_of(std::string_view("\0 ", 2)) + 1);
    return text;
}
template <typename T>
T value_of(cl_device_id device, cl_device_info what) {
    T value{};
    return clGetDeviceInfo(device, what, sizeof value, &value, nullptr) == CL_SUCCESS ? value : T{};
}
inline bool is_cpu(cl_device_id device) {
    return (value_of<cl_device_type>(device, CL_DEVICE_TYPE) & CL_DEVICE_TYPE_CPU) != 0;
}

class DeviceBuffer : public Buffer {
public:
    DeviceBuffer(cl_context context, std::size_t bytes) : bytes_(bytes) {
        cl_int status = CL_SUCCESS;
        memory_.reset(clCreateBuffer(context, CL_MEM_READ_WRITE, bytes, nullptr, &status));
        check(status, "a buffer of " + std::to_string(bytes) + " bytes");
    }
    std::size_t bytes() const override { return bytes_; }
    cl_mem memory() const { return memory_.get(); }

private:
    Memory memory_;
    std::size_t bytes_;
};

/// Null for no buffer: an empty array has none.
inline cl_mem memory_of(const Buffer* buffer) {
    return buffer ? static_cast<const DeviceBuffer&>(*buffer).memory() : nullptr;
}

} // namespace raycontact::opencl
