// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sched.h>

namespace raycontact {

/// Binds the calling thread to one core, and gives it its old cores back.
class Pin {
public:
    void enter(int core) {
        if (sched_getaffinity(0, sizeof before_, &before_) != 0) return;
        cpu_set_t one;
        CPU_ZERO(&one);
        CPU_SET(core, &one);
        pinned_ = sched_setaffinity(0, sizeof one, &one) == 0;
    }
    void leave() {
        if (pinned_) sched_setaffinity(0, sizeof before_, &before_);
        pinned_ = false;
    }

private:
    cpu_set_t before_{};
    bool pinned_ = false;
};

} // namespace raycontact
