// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/device/measure.h"

#include <bench/peers/machine.h>

#include <filesystem>
#include <string>

namespace raycontact::bench {

/// For a person.
std::string table(const Machine& machine, const Work& work, const DeviceOptions& options, const DeviceResults& results);
/// One object, on a line.
std::string json(const Machine& machine, const Work& work, const DeviceOptions& options, const DeviceResults& results);
/// DIR/<machine>/device-<date>.csv: for each device, method and caster a row of the step and one of each kernel; for
/// each device a row of each bandwidth. Returns its path.
std::filesystem::path write_results(const std::filesystem::path& folder, const Machine& machine, const Work& work,
                                    const DeviceOptions& options, const DeviceResults& results);

} // namespace raycontact::bench
