// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>
#include <raycontact/library_mode.h>

#include <cstdint>
#include <string>
#include <vector>

namespace raycontact {

/// A device as `raycontact devices` lists it.
struct DeviceInfo {
    std::string id;                 ///< as Execution::devices takes it
    std::string kind;               ///< its back end: the id up to a colon
    std::string type;               ///< "cpu", "gpu" or "other"
    std::string bus;                ///< address of the card, as "0000:65:00.0"; empty where none is known
    std::string name;               ///< as its driver gives it
    std::string driver;             ///< its version, in the words of the driver
    std::uint32_t cores = 0;        ///< as the driver counts them
    std::uint64_t memory_bytes = 0; ///< of its own; of a CPU the host's
    /// The driver says that division and root are correctly rounded and denormals kept, as needed for the bits of every
    /// other exact device. Opening the device checks it.
    bool exact = false;
    bool usable = false; ///< it can be opened, as far as can be told without opening it
    std::string why_not; ///< empty when usable
};

/// What a device did in one step.
struct DeviceWork {
    std::string device;           ///< its id
    std::uint64_t pairs = 0;      ///< unordered pairs of bodies that were its own
    std::uint64_t launches = 0;   ///< kernels started, those of prefix sums included
    std::uint64_t reads = 0;      ///< times the host waited for it
    std::uint64_t bytes_up = 0;   ///< copied to its memory; what it shares with the host is not copied
    std::uint64_t bytes_down = 0; ///< copied from its memory
    double busy_ms = 0;           ///< in which its kernels ran
    double load = 0;              ///< what it had to do: counted, in units of a pair at rest
    double ms = 0;                ///< it took for that, with the host's share; devices work side by side
};

struct Settings;

/// The ids that Execution::devices stands for: of "auto" the CPU and, if there is one, the GPU that a scene may choose
/// instead. Throws InputError for a list that is malformed or names a device twice or beside its own part; does not
/// open any.
RAYCONTACT_API std::vector<std::string> chosen_devices(const Settings& settings);

/// The CPU, then every device that a driver offers, in the same order each time. Never throws for a missing driver.
RAYCONTACT_API std::vector<DeviceInfo> list_devices();

} // namespace raycontact
