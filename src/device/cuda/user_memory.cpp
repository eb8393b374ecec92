// SPDX-License-Identifier: Apache-2.0
#include "device/user_memory.h"
#include "device/cuda/handle.h"

#include <raycontact/error.h>

namespace raycontact::cuda {

namespace {

DeviceNumber device_of(Address address) {
    const std::string named = "memory of a CUDA device: ";
    if (const std::string why_not = driver().why_not(); !why_not.empty()) throw InputError(named + why_not);
    check(driver().cuInit(0), "cuInit");
    constexpr int ordinal_attribute = 9;
    int ordinal = -1;
    if (driver().cuPointerGetAttribute(&ordinal, ordinal_attribute, address) != 0 || ordinal < 0)
        throw InputError(named + "address " + std::to_string(address) + " is none of a device");
    DeviceNumber device = 0;
    check(driver().cuDeviceGet(&device, ordinal), "cuDeviceGet");
    return device;
}

// Copies wait for each other in the caller's stream.
class Stretch : public UserMemory::Access {
public:
    Stretch(Address address, void* stream)
        : context_(device_of(address)), address_(address), waits_for_all_(stream == UserMemory::every_stream()),
          stream_(waits_for_all_ ? nullptr : static_cast<StreamHandle>(stream)) {}

    void read(std::span<std::byte> to) const override {
        const Current current(context_);
        wait_for_all();
        check(driver().cuMemcpyDtoHAsync(to.data(), address_, to.size(), stream_), "cuMemcpyDtoHAsync");
    }
    void write(std::span<const std::byte> from) const override {
        const Current current(context_);
        wait_for_all();
        check(driver().cuMemcpyHtoDAsync(address_, from.data(), from.size(), stream_), "cuMemcpyHtoDAsync");
    }
    void finish() const override {
        const Current current(context_);
        check(driver().cuStreamSynchronize(stream_), "cuStreamSynchronize");
    }

private:
    void wait_for_all() const {
        if (waits_for_all_) check(driver().cuCtxSynchronize(), "cuCtxSynchronize");
    }

    PrimaryContext context_;
    Address address_;
    bool waits_for_all_;
    StreamHandle stream_;
};

} // namespace

std::shared_ptr<const UserMemory::Access> user_memory(std::uint64_t address, void* stream) {
    return std::make_shared<Stretch>(address, stream);
}

} // namespace raycontact::cuda
