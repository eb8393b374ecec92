// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/forwarding.h"

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

/// Keeps every buffer as each launch leaves it. New buffers are zeroed. shares_memory: false: shapes are copied to it,
/// as to a card, so that the buffers hold what a card's hold.
class TracingDevice : public ForwardingDevice {
public:
    /// The trace outlives the device, which a part takes for itself.
    TracingDevice(std::unique_ptr<Device> inner, std::shared_ptr<Trace> trace, bool shares_memory)
        : ForwardingDevice(std::move(inner)), trace_(std::move(trace)), traits_(ForwardingDevice::traits()) {
        traits_.shares_memory = shares_memory;
    }

    const DeviceTraits& traits() const override { return traits_; }

    std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override;

private:
    void launch(KernelId kernel, Count count, std::span<const Argument> arguments) override;
    kernels::uint scan(const ScanOf& scan) override;

    void keep(std::string_view kernel, std::size_t argument, const Buffer* buffer);

    std::shared_ptr<Trace> trace_;
    DeviceTraits traits_;
    /// What most launches leave as it was is kept once.
    std::unordered_map<const Buffer*, std::shared_ptr<const std::vector<std::byte>>> last_;
};

/// Every kernel, by KernelId.
std::span<const char* const> kernel_names();

} // namespace raycontact::device_test
