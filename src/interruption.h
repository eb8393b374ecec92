// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/interruption.h>

namespace raycontact {

/// That ends what this thread does; null: nothing does.
extern constinit thread_local const std::atomic<bool>* interruption_flag;

/// Made before a loop that may take long, and asked in it: throws Interrupted once the work is to end.
class InterruptionCheck {
public:
    void operator()() const {
        if (flag_ != nullptr && flag_->load(std::memory_order_relaxed)) [[unlikely]]
            end();
    }
    bool can_end() const { return flag_ != nullptr; }

private:
    [[noreturn]] static void end();
    const std::atomic<bool>* flag_ = interruption_flag;
};

} // namespace raycontact
