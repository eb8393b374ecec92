// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <raycontact/settings.h>

#include <vector>

namespace raycontact {

/// Opens what chosen_devices() names. Throws InputError for a device that is unknown or that this version cannot use.
std::vector<OpenDevice> open_devices(const Settings& settings);

} // namespace raycontact
