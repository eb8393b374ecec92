// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/cuda/handle.h"
#include "device/device.h"

namespace raycontact::cuda {

class DeviceBuffer : public Buffer {
public:
    /// The context is current.
    DeviceBuffer(std::shared_ptr<const Context> context, std::size_t bytes)
        : context_(std::move(context)), bytes_(bytes) {
        check(driver().cuMemAlloc(&address_, bytes), "a buffer of " + std::to_string(bytes) + " bytes");
    }
    ~DeviceBuffer() override {
        context_->when_current([&] {
            // Kernels that were started may still use it; where even the wait fails, it goes with the context.
            if (driver().cuStreamSynchronize(context_->stream()) == 0) driver().cuMemFree(address_);
        });
    }
    DeviceBuffer(const DeviceBuffer&) = delete;
    DeviceBuffer& operator=(const DeviceBuffer&) = delete;

    std::size_t bytes() const override { return bytes_; }
    Address address() const { return address_; }

private:
    std::shared_ptr<const Context> context_;
    Address address_ = 0;
    std::size_t bytes_;
};

/// 0, the null pointer, for no buffer: an empty array has none.
inline Address address_of(const Buffer* buffer) {
    return buffer ? static_cast<const DeviceBuffer&>(*buffer).address() : 0;
}

} // namespace raycontact::cuda
