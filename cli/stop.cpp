// SPDX-License-Identifier: Apache-2.0
#include "cli/stop.h"

#include <csignal>

namespace {

volatile std::sig_atomic_t came = 0;

void note(int signal) {
    if (came == 0) came = signal;
}

} // namespace

void listen_for_stop() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction before {};
        if (sigaction(signal, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) continue;
        struct sigaction action {};
        action.sa_handler = note;
        action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
        sigemptyset(&action.sa_mask);
        sigaction(signal, &action, nullptr);
    }
}

int stop_signal() {
    return came;
}

std::string stop_name() {
    return came == SIGINT ? "SIGINT" : came == SIGTERM ? "SIGTERM" : came == SIGHUP ? "SIGHUP" : "";
}
