// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/forwarding.h"

namespace raycontact {

/// Counts what a device is asked for.
class CountingDevice : public ForwardingDevice {
public:
    using ForwardingDevice::ForwardingDevice;

    /// The work since the last call. The caller fills in `device` and `pairs`.
    DeviceWork take_work();

private:
    void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) override;
    void read(std::span<const Piece> pieces) override;
    void launch(KernelId kernel, Count count, std::span<const Argument> arguments) override;
    kernels::uint scan(const ScanOf& scan) override;
    void finish() override;

    DeviceWork work_;
    double busy_before_ = 0;
};

} // namespace raycontact
