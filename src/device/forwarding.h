// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <utility>

namespace raycontact {

/// Passes every call on to the device that it owns. Others override what they count, time or trace.
class ForwardingDevice : public Device, protected Queue {
public:
    explicit ForwardingDevice(std::unique_ptr<Device> inner) : inner_(std::move(inner)) {}

    const DeviceInfo& info() const override { return inner_->info(); }
    const DeviceTraits& traits() const override { return inner_->traits(); }
    std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override { return inner_->make_buffer(bytes); }
    Queue& queue() override { return *this; }

protected:
    Queue& inner() const { return inner_->queue(); }

    void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) override {
        inner().write(to, offset, from, bytes);
    }
    void read(std::span<const Piece> pieces) override { inner().read(pieces); }
    void copy(Buffer& to, const Buffer& from, std::size_t bytes) override { inner().copy(to, from, bytes); }
    void launch(KernelId kernel, Count count, std::span<const Argument> arguments) override {
        inner().launch(kernel, count, arguments);
    }
    kernels::uint scan(const ScanOf& scan) override { return inner().scan(scan); }
    void finish() override { inner().finish(); }
    double busy_ms() const override { return inner().busy_ms(); }

private:
    std::unique_ptr<Device> inner_;
};

} // namespace raycontact
