// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"
#include "device/opencl/handle.h"

namespace raycontact::opencl {

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
