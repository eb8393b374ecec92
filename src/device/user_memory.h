// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/user_memory.h>

namespace raycontact {

class UserMemory::Access {
public:
    virtual ~Access() = default;
    /// Both may return before the copy is done. No more than the stretch has.
    virtual void read(std::span<std::byte> to) const = 0;
    virtual void write(std::span<const std::byte> from) const = 0;
    virtual void finish() const = 0;
};

namespace cuda {
std::shared_ptr<const UserMemory::Access> user_memory(std::uint64_t address, void* stream);
} // namespace cuda
namespace opencl {
std::shared_ptr<const UserMemory::Access> user_memory(void* queue, void* buffer, std::size_t bytes, std::size_t offset);
} // namespace opencl

} // namespace raycontact
