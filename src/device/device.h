// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"
#include "executor/executor.h"

#include <raycontact/device.h>
#include <raycontact/settings.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace raycontact {

/// A device failed: it ran out of memory, was lost, or its driver stopped a kernel. Nothing on it can be relied on
/// any more.
class DeviceError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Device memory. Freed with its last owner.
class Buffer {
public:
    virtual ~Buffer() = default;
    virtual std::size_t bytes() const = 0;
    /// The memory, if the host shares it, to read and write while no launch runs; else null.
    virtual void* host() const { return nullptr; }
};

/// One kernel argument: a buffer (null for an empty array) or a 32-bit scalar.
struct Argument {
    const Buffer* buffer = nullptr;
    kernels::uint scalar = 0;
    bool is_scalar = false;
};

/// The number of items of a launch: a value, or a place in a buffer of 32-bit numbers that a kernel has written. The
/// host need not know the latter.
struct Count {
    Count(std::size_t number); ///< throws InputError beyond 32 bits
    Count(const Buffer* in, std::size_t at, std::size_t at_most)
        : buffer(in), value(static_cast<kernels::uint>(at)), most(static_cast<kernels::uint>(at_most)) {}

    const Buffer* buffer = nullptr; ///< null: `value` is the number
    kernels::uint value = 0;        ///< else: the place of the number in the buffer
    kernels::uint most = 0;         ///< upper bound of the number
};

/// A part of a buffer, and the host memory to copy it to.
struct Piece {
    void* to = nullptr;
    const Buffer* from = nullptr;
    std::size_t offset = 0, bytes = 0;
};

/// What a scan works on, a table: values[c * stride + i] is item i of column c. The scan sets firsts[i] to the sum of
/// column 0 before item i, behind `before` results that are none of its items', and totals[at] to the sums of all
/// columns. `room`: most results that the caller can store, with those before (see kernels::Totals).
struct ScanOf {
    Count count;
    kernels::uint columns = 1, stride = 0;
    const Buffer* values = nullptr;
    Buffer* firsts = nullptr;
    Buffer* totals = nullptr;
    kernels::uint at = 0, room = 0, before = 0;
};

/// Runs work in order. Every call but read() and finish() may return before the work is done.
class Queue {
public:
    virtual ~Queue() = default;
    /// Has read its source when it returns: the caller may change or free it at once.
    virtual void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) = 0;
    /// Waits once, for all pieces.
    virtual void read(std::span<const Piece> pieces) = 0;
    virtual void copy(Buffer& to, const Buffer& from, std::size_t bytes) = 0;
    virtual void launch(KernelId kernel, Count count, std::span<const Argument> arguments) = 0;
    /// Returns the number of kernels launched: one for up to SCAN_AT_ONCE items, else three.
    virtual kernels::uint scan(const ScanOf& scan) = 0;
    virtual void finish() = 0;
    /// Milliseconds in which kernels ran since the device was opened; counts kernels that were waited for.
    virtual double busy_ms() const = 0;
};

/// What a device can do.
struct DeviceTraits {
    bool has_double = true;     ///< else the host places the pairs, in double
    bool shares_memory = false; ///< Buffer::host() is never null
};

class Device {
public:
    virtual ~Device() = default;
    virtual const DeviceInfo& info() const = 0;
    virtual const DeviceTraits& traits() const = 0;
    virtual std::unique_ptr<Buffer> make_buffer(std::size_t bytes) = 0;
    virtual Queue& queue() = 0;
};

/// A device, and the host threads that prepare its work and finish its results.
struct OpenDevice {
    std::unique_ptr<Executor> executor;
    std::unique_ptr<Device> device;
};

/// Opens one device of chosen_devices(). Throws InputError for a device that is unknown or that this version cannot
/// use. threads: of the host, 0 for one per core. inexact: also opens a device whose bits differ from the others'.
OpenDevice open_device(std::string_view name, std::uint32_t threads, bool inexact = false,
                       const TaskSystem& tasks = {});
/// Opens all that chosen_devices() names; of "auto" the CPU alone.
std::vector<OpenDevice> open_devices(const Settings& settings);
/// Opens a device, if there is one. Throws as open_device().
using Opener = std::function<std::optional<OpenDevice>()>;
/// For "auto": opens the GPU that a scene may choose instead of the CPU. Drivers are asked once for all scenes, at the
/// first call. Empty for a list.
Opener gpu_opener(const Settings& settings);

} // namespace raycontact
