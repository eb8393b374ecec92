// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace raycontact {
class Device;
}

namespace raycontact::bench {

/// What a device's memory, bus and driver allow, measured: medians of nine.
struct Bandwidth {
    double write = 0, read = 0; ///< GB/s between host and device, through Queue::write and read
    double copy = 0;            ///< GB/s within the device, every byte counted twice: read and written
    double launch_us = 0;       ///< an empty launch, as one of a hundred in a row
    double wait_us = 0;         ///< an empty launch and the wait for it
};

Bandwidth measure_bandwidth(Device& device);

} // namespace raycontact::bench
