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
    virtual void* host() const { return nullptr; }
};

/// One kernel argument: a buffer, which an empty array may lack, or a 32-bit scalar.
struct Argument {
    const Buffer* buffer = nullptr;
    kernels::uint scalar = 0;
    bool is_scalar = false;
};

/// How many items there are: a number, or what a kernel left in a buffer of 32-bit numbers. The host need not know it.
struct Count {
    Count(std::size_t number); ///< throws std::length_error beyond 32 bits
    Count(const Buffer* in, std::size_t at, std::size_t at_most)
        : buffer(in), value(static_cast<kernels::uint>(at)), most(static_cast<kernels::uint>(at_most)) {}

    const Buffer* buffer = nullptr; ///< null: `value` is the number
    kernels::uint value = 0;        ///< else its place in the buffer
    kernels::uint most = 0;         ///< it is no more than this
};

/// A part of a buffer, and where the host wants it.
struct Piece {
    void* to = nullptr;
    const Buffer* from = nullptr;
    std::size_t offset = 0, bytes = 0;
};

/// Sums of the columns of a table: values[c * stride + i] is item i of column c. firsts[i] becomes the sum of column 0
/// before item i; the sums go to totals[at], with room for `room` results (kernels::Totals says how).
struct ScanOf {
    Count count;
    kernels::uint columns = 1, stride = 0;
    const Buffer* values = nullptr;
    Buffer* firsts = nullptr;
    Buffer* totals = nullptr;
    kernels::uint at = 0, room = 0;
};

/// Work in order. Every call but read() and finish() may return before the work is done.
class Queue {
public:
    virtual ~Queue() = default;
    /// Has read its source when it returns: the caller may change or free it at once.
    virtual void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) = 0;
    /// Waits once, for all pieces.
    virtual void read(std::span<const Piece> pieces) = 0;
    virtual void copy(Buffer& to, const Buffer& from, std::size_t bytes) = 0;
    virtual void launch(KernelId kernel, Count count, std::span<const Argument> arguments) = 0;
    /// Returns how many kernels that takes: one up to SCAN_AT_ONCE items, three above.
    virtual kernels::uint scan(const ScanOf& scan) = 0;
    virtual void finish() = 0;
    /// Milliseconds in which kernels ran since the device was opened, of all that has been waited for.
    virtual double busy_ms() const = 0;
};

/// What a device can do.
struct DeviceTraits {
    bool has_double = true;     ///< else the host runs the kernels that compute in double
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

/// Opens what `--devices` names. Throws InputError for a device that is unknown or that this version cannot use.
/// threads: of the host, 0 for one per core. inexact: also a device that gives other bits than the rest.
OpenDevice open_device(std::string_view name, std::uint32_t threads, bool inexact = false);

} // namespace raycontact
