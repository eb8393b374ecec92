// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <cstddef>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

namespace raycontact::device_test {

/// What a buffer held after a launch: all of it, so that a stray write or a changed input shows too.
struct Written {
    std::string kernel;
    std::size_t argument = 0; ///< counted without the count
    std::shared_ptr<const std::vector<std::byte>> bytes;
};
using Trace = std::vector<Written>;

/// Empty when both are equal byte for byte, else the first kernel, argument and byte that differ.
std::string first_difference(const Trace& expected, const Trace& actual);

/// How often a kernel was launched with something in its buffers.
std::size_t launches_of(const Trace& trace, std::string_view kernel);

/// Passes everything on to another device and keeps every buffer as each launch leaves it. New buffers are zeroed.
class TracingDevice : public Device, private Queue {
public:
    /// The trace outlives the device, which a part takes for itself.
    TracingDevice(std::unique_ptr<Device> inner, std::shared_ptr<Trace> trace)
        : inner_(std::move(inner)), trace_(std::move(trace)) {}

    const DeviceInfo& info() const override { return inner_->info(); }
    const DeviceTraits& traits() const override { return inner_->traits(); }
    std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override;
    Queue& queue() override { return *this; }

private:
    void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) override;
    void read(std::span<const Piece> pieces) override;
    void copy(Buffer& to, const Buffer& from, std::size_t bytes) override;
    void launch(KernelId kernel, Count count, std::span<const Argument> arguments) override;
    kernels::uint scan(const ScanOf& scan) override;
    void finish() override { inner_->queue().finish(); }
    double busy_ms() const override { return inner_->queue().busy_ms(); }

    void keep(std::string_view kernel, std::size_t argument, const Buffer* buffer);

    std::unique_ptr<Device> inner_;
    std::shared_ptr<Trace> trace_;
    /// What most launches leave as it was is kept once.
    std::unordered_map<const Buffer*, std::shared_ptr<const std::vector<std::byte>>> last_;
};

/// Every kernel, by KernelId.
std::span<const char* const> kernel_names();

} // namespace raycontact::device_test
