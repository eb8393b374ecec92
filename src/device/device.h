// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"
#include "executor/executor.h"

#include <raycontact/device.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

namespace raycontact {

/// Device memory. Freed with its last owner.
class Buffer {
public:
    virtual ~Buffer() = default;
    virtual std::size_t bytes() const = 0;
    /// Where the host may read and write it while no launch is under way; null where it cannot.
    virtual void* host() { return nullptr; }
};

/// One kernel argument: a buffer, or a 32-bit scalar.
struct Argument {
    Buffer* buffer = nullptr;
    kernels::uint scalar = 0;
};

/// Work in order. Every call may return before the work is done; read() waits for its data.
class Queue {
public:
    virtual ~Queue() = default;
    virtual void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) = 0;
    virtual void read(void* to, const Buffer& from, std::size_t offset, std::size_t bytes) = 0;
    virtual void copy(Buffer& to, const Buffer& from, std::size_t bytes) = 0;
    virtual void launch(KernelId kernel, kernels::uint count, std::span<const Argument> arguments) = 0;
    virtual void finish() = 0;
};

class Device {
public:
    virtual ~Device() = default;
    virtual const DeviceInfo& info() const = 0;
    virtual std::unique_ptr<Buffer> make_buffer(std::size_t bytes) = 0;
    virtual Queue& queue() = 0;
};

/// A device, and the host threads that prepare its work and finish its results.
struct OpenDevice {
    std::unique_ptr<Executor> executor;
    std::unique_ptr<Device> device;
};

/// Opens what `--devices` names. Throws InputError for a device that is unknown or that this version cannot use.
/// threads: of the host, 0 for one per core.
OpenDevice open_device(std::string_view name, std::uint32_t threads);

} // namespace raycontact
