// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/forwarding.h"

#include <utility>

namespace raycontact {

/// Counts what a device is asked for.
class CountingDevice : public ForwardingDevice {
public:
    using ForwardingDevice::ForwardingDevice;

    /// The work since the last call. The caller fills in `device` and `pairs`.
    DeviceWork take_work() {
        const double busy = busy_ms();
        work_.busy_ms = busy - std::exchange(busy_before_, busy);
        return std::exchange(work_, {});
    }

private:
    void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) override {
        work_.bytes_up += bytes;
        inner().write(to, offset, from, bytes);
    }
    void read(std::span<const Piece> pieces) override {
        ++work_.reads;
        for (const Piece& piece : pieces) work_.bytes_down += piece.bytes;
        inner().read(pieces);
    }
    void launch(KernelId kernel, Count count, std::span<const Argument> arguments) override {
        ++work_.launches;
        inner().launch(kernel, count, arguments);
    }
    kernels::uint scan(const ScanOf& scan) override {
        const kernels::uint launches = inner().scan(scan);
        work_.launches += launches;
        return launches;
    }
    /// Counts as a read: the host waits before it touches shared memory.
    void finish() override {
        ++work_.reads;
        inner().finish();
    }

    DeviceWork work_;
    double busy_before_ = 0;
};

} // namespace raycontact
