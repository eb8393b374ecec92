// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/cuda/driver.h"
#include "device/device.h"

#include <memory>
#include <type_traits>
#include <utility>

namespace raycontact::cuda {

/// The device's primary context, which all who use the device in this process share.
class PrimaryContext {
public:
    explicit PrimaryContext(DeviceNumber device) : device_(device) {
        check(driver().cuDevicePrimaryCtxRetain(&handle_, device), "cuDevicePrimaryCtxRetain");
    }
    ~PrimaryContext() { driver().cuDevicePrimaryCtxRelease(device_); }
    PrimaryContext(const PrimaryContext&) = delete;
    PrimaryContext& operator=(const PrimaryContext&) = delete;

    ContextHandle handle() const { return handle_; }

private:
    DeviceNumber device_;
    ContextHandle handle_ = nullptr;
};

/// Makes a context the calling thread's, and puts back what was current when it goes: threads change between calls, and
/// the caller may use CUDA, too.
class Current {
public:
    explicit Current(const PrimaryContext& context) {
        check(driver().cuCtxPushCurrent(context.handle()), "cuCtxPushCurrent");
    }
    ~Current() {
        ContextHandle popped = nullptr;
        driver().cuCtxPopCurrent(&popped);
    }
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;
};

/// It, and our own stream in it.
class Context : public PrimaryContext {
public:
    explicit Context(DeviceNumber device) : PrimaryContext(device) {
        constexpr unsigned non_blocking = 1; // does not wait for the streams of others
        const Current current(*this);
        check(driver().cuStreamCreate(&stream_, non_blocking), "cuStreamCreate");
    }
    ~Context() {
        when_current([&] { driver().cuStreamDestroy(stream_); });
    }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    StreamHandle stream() const { return stream_; }

    /// Releases something while the context is current. For destructors: a lost device releases nothing, and says so to
    /// nobody.
    template <typename Release>
    void when_current(Release release) const {
        if (driver().cuCtxPushCurrent(handle()) != 0) return;
        release();
        ContextHandle popped = nullptr;
        driver().cuCtxPopCurrent(&popped);
    }

private:
    StreamHandle stream_ = nullptr;
};

/// Releases a handle in its context.
template <auto release>
struct Release {
    std::shared_ptr<const Context> context;
    void operator()(auto* handle) const {
        context->when_current([&] { (driver().*release)(handle); });
    }
};
template <typename Handle, Function<Status(Handle)> Driver::*release>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release<release>>;

using Event = Owned<EventHandle, &Driver::cuEventDestroy>;
using Module = Owned<ModuleHandle, &Driver::cuModuleUnload>;
using HostMemory = Owned<void*, &Driver::cuMemFreeHost>; ///< pinned: copies to and from it need not wait

// What they return lies in the context, which is current.

inline Event make_event(const std::shared_ptr<const Context>& context, bool timed) {
    constexpr unsigned default_flags = 0, without_time = 2;
    EventHandle handle = nullptr;
    check(driver().cuEventCreate(&handle, timed ? default_flags : without_time), "cuEventCreate");
    return Event(handle, {context});
}

inline HostMemory make_host_memory(const std::shared_ptr<const Context>& context, std::size_t bytes) {
    void* memory = nullptr;
    check(driver().cuMemHostAlloc(&memory, bytes, 0), "pinned host memory of " + std::to_string(bytes) + " bytes");
    return HostMemory(memory, {context});
}

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
