// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/forwarding.h"

#include <memory>
#include <string>
#include <vector>

namespace raycontact::device_test {

/// What goes wrong, and at which call.
enum class Fault {
    none,
    once,     ///< this call fails: no memory, a transfer or a launch that the driver refuses
    lost,     ///< this call and every later one
    watchdog, ///< a launch is stopped: the next call that waits fails, and every later one
};

/// What a fake device was asked for, and where it is to fail. Shared with the test.
struct Script {
    Fault fault = Fault::none;
    std::size_t at = 0;             ///< number of the call that fails, from the last start() on
    std::vector<std::string> calls; ///< since then: a kernel's number, or "allocate", "write", "read", "copy", "scan"
    std::size_t failed = 0;         ///< calls that threw

    void start(Fault next, std::size_t next_at) {
        fault = next;
        at = next_at;
        calls.clear();
        failed = 0;
    }
};

/// The CPU's device, wrapped. shares_memory: false for one that behaves like a card.
OpenDevice open_fake(const std::string& id, std::shared_ptr<Script> script, bool shares_memory);

} // namespace raycontact::device_test
