// SPDX-License-Identifier: Apache-2.0
#include "device/user_memory.h"

#include <raycontact/error.h>

#include <algorithm>
#include <string>
#include <utility>

namespace raycontact {

namespace {

class HostMemory : public UserMemory::Access {
public:
    explicit HostMemory(std::span<std::byte> memory) : memory_(memory) {}
    void read(std::span<std::byte> to) const override { std::ranges::copy(memory_.first(to.size()), to.begin()); }
    void write(std::span<const std::byte> from) const override { std::ranges::copy(from, memory_.begin()); }
    void finish() const override {}

private:
    std::span<std::byte> memory_;
};

void check_room(std::size_t bytes, std::size_t room) {
    if (bytes > room)
        throw InputError("memory of " + std::to_string(room) + " bytes is too small; this needs "
                         + std::to_string(bytes));
}

} // namespace

UserMemory::UserMemory(std::shared_ptr<const Access> access, std::size_t bytes)
    : access_(std::move(access)), bytes_(bytes) {}

UserMemory UserMemory::host(std::span<std::byte> bytes) {
    return UserMemory(std::make_shared<HostMemory>(bytes), bytes.size());
}

UserMemory UserMemory::cuda([[maybe_unused]] std::uint64_t address, [[maybe_unused]] std::size_t bytes,
                            [[maybe_unused]] void* stream) {
#ifdef RAYCONTACT_CUDA
    if (bytes == 0) return host({}); // an empty array has no address
    return UserMemory(cuda::user_memory(address, stream), bytes);
#else
    throw InputError("memory of a CUDA device: this raycontact was not built with CUDA (configure with "
                     "RAYCONTACT_CUDA=ON)");
#endif
}

void* UserMemory::every_stream() noexcept {
    return reinterpret_cast<void*>(~std::uintptr_t{0});
}

UserMemory UserMemory::opencl([[maybe_unused]] void* queue, [[maybe_unused]] void* buffer,
                              [[maybe_unused]] std::size_t bytes, [[maybe_unused]] std::size_t offset) {
#ifdef RAYCONTACT_OPENCL
    return UserMemory(opencl::user_memory(queue, buffer, bytes, offset), bytes);
#else
    throw InputError("memory of an OpenCL buffer: this raycontact was not built with OpenCL (configure with "
                     "RAYCONTACT_OPENCL=ON)");
#endif
}

void UserMemory::read(std::span<std::byte> to) const {
    check_room(to.size(), bytes());
    if (to.empty()) return;
    access_->read(to);
    access_->finish();
}
void UserMemory::write(std::span<const std::byte> from) const {
    check_room(from.size(), bytes());
    if (!from.empty()) access_->write(from);
}
void UserMemory::finish() const {
    access_->finish();
}

} // namespace raycontact
