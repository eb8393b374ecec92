// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <cstddef>
#include <string>
#include <vector>

namespace raycontact::device_test {

/// What a buffer held after a launch: all of it, so that a stray write or a changed input shows too.
struct Written {
    KernelId kernel{};
    std::size_t argument = 0; ///< counted without the range and the count
    std::vector<std::byte> bytes;
};

/// Empty when both are equal byte for byte, else the first kernel, argument and byte that differ.
std::string first_difference(const std::vector<Written>& expected, const std::vector<Written>& actual);

/// Passes everything on to another device and keeps every buffer as each launch leaves it. New buffers are zeroed.
class TracingDevice : public Device, private Queue {
public:
    explicit TracingDevice(Device& inner) : inner_(inner) {}

    const std::vector<Written>& trace() const { return trace_; }

    const DeviceInfo& info() const override { return inner_.info(); }
    std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override;
    Queue& queue() override { return *this; }

private:
    void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) override;
    void read(void* to, const Buffer& from, std::size_t offset, std::size_t bytes) override;
    void copy(Buffer& to, const Buffer& from, std::size_t bytes) override;
    void launch(KernelId kernel, kernels::uint count, std::span<const Argument> arguments) override;
    void finish() override { inner_.queue().finish(); }

    Device& inner_;
    std::vector<Written> trace_;
};

const char* kernel_name(KernelId kernel);

} // namespace raycontact::device_test
