// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace raycontact {

/// A device as `raycontact devices` lists it.
struct DeviceInfo {
    std::string id;   ///< as Settings::device takes it
    std::string kind; ///< its back end: the id up to a colon
    std::string name;
    std::string driver;
    std::uint32_t cores = 0;
    std::uint64_t memory_bytes = 0;
    bool exact = false; ///< correctly rounded division and root, denormals: same bits as every other exact device
    bool usable = false;
    std::string why_not; ///< empty when usable
};

/// What a device did in one step.
struct DeviceWork {
    std::string device;           ///< its id
    std::uint64_t pairs = 0;      ///< unordered pairs of bodies that were its own
    std::uint64_t launches = 0;   ///< kernels started, those of prefix sums included
    std::uint64_t reads = 0;      ///< times the host waited for it
    std::uint64_t bytes_up = 0;   ///< copied to its memory; none where it works in the host's
    std::uint64_t bytes_down = 0; ///< copied from its memory
    double busy_ms = 0;           ///< in which its kernels ran
};

/// Every device that this version knows how to use: the CPU alone so far. Never throws for a missing driver.
std::vector<DeviceInfo> list_devices();

} // namespace raycontact
