// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"
#include "executor/executor.h"

namespace raycontact::cpu {

/// Runs on the executor's threads, which must outlive it. instruction_set: of usable_tables(), empty for the widest.
std::unique_ptr<Device> open(Executor& executor, std::string_view instruction_set, std::string_view id = "cpu");

DeviceInfo describe();

} // namespace raycontact::cpu
