// SPDX-License-Identifier: Apache-2.0
#include "device/cuda/handle.h"

namespace raycontact::cuda {

Context::Context(DeviceNumber device) : device_(device) {
    check(driver().cuDevicePrimaryCtxRetain(&handle_, device), "cuDevicePrimaryCtxRetain");
    try {
        constexpr unsigned non_blocking = 1; // does not wait for the streams of others
        const Current current(*this);
        check(driver().cuStreamCreate(&stream_, non_blocking), "cuStreamCreate");
    } catch (const DeviceError&) {
        driver().cuDevicePrimaryCtxRelease(device);
        throw;
    }
}

Context::~Context() {
    when_current([&] { driver().cuStreamDestroy(stream_); });
    driver().cuDevicePrimaryCtxRelease(device_);
}

Event make_event(const std::shared_ptr<const Context>& context, bool timed) {
    constexpr unsigned default_flags = 0, without_time = 2;
    EventHandle handle = nullptr;
    check(driver().cuEventCreate(&handle, timed ? default_flags : without_time), "cuEventCreate");
    return {context, handle};
}

HostMemory make_host_memory(const std::shared_ptr<const Context>& context, std::size_t bytes) {
    void* memory = nullptr;
    check(driver().cuMemHostAlloc(&memory, bytes, 0), "pinned host memory of " + std::to_string(bytes) + " bytes");
    return {context, memory};
}

} // namespace raycontact::cuda
