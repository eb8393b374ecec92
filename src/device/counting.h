// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

namespace raycontact {

/// Passes every call on to another device and counts it.
class CountingDevice : public Device, private Queue {
public:
    explicit CountingDevice(std::unique_ptr<Device> inner) : inner_(std::move(inner)) {}

    /// The work since the last call. The caller fills in `device` and `pairs`.
    DeviceWork take_work();

    const DeviceInfo& info() const override { return inner_->info(); }
    const DeviceTraits& traits() const override { return inner_->traits(); }
    std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override { return inner_->make_buffer(bytes); }
    Queue& queue() override { return *this; }

private:
    void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) override;
    void read(std::span<const Piece> pieces) override;
    void copy(Buffer& to, const Buffer& from, std::size_t bytes) override { inner_->queue().copy(to, from, bytes); }
    void launch(KernelId kernel, Count count, std::span<const Argument> arguments) override;
    kernels::uint scan(const ScanOf& scan) override;
    void finish() override;
    double busy_ms() const override { return inner_->queue().busy_ms(); }

    std::unique_ptr<Device> inner_;
    DeviceWork work_;
    double busy_before_ = 0;
};

} // namespace raycontact
