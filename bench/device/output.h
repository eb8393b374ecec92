// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/device/measure.h"

#include <bench/peers/files.h>

#include <string>

namespace raycontact::bench {

/// For a person.
std::string table(const Machine& machine, const Work& work, const DeviceOptions& options, const DeviceResults& results);
/// One object, on a line.
std::string json(const Machine& machine, const Work& work, const DeviceOptions& options, const DeviceResults& results);
/// device-<date>.csv: for each device, method and caster a row of the step and one of each kernel; for each device a
/// row of each bandwidth.
void write_results(output::OutFolder& folder, const Machine& machine, const Work& work, const DeviceOptions& options,
                   const DeviceResults& results);

} // namespace raycontact::bench
