// SPDX-License-Identifier: Apache-2.0
#include "interruption.h"

#include <utility>

namespace raycontact {

constinit thread_local const std::atomic<bool>* interruption_flag = nullptr;

Interruptible::Interruptible(const std::atomic<bool>* flag) : outer_(std::exchange(interruption_flag, flag)) {}

Interruptible::~Interruptible() {
    interruption_flag = outer_;
}

void InterruptionCheck::end() {
    throw Interrupted();
}

} // namespace raycontact
