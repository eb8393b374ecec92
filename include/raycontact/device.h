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

/// Every device that this version knows how to use: the CPU alone so far. Never throws for a missing driver.
std::vector<DeviceInfo> list_devices();

} // namespace raycontact
