// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

// SIGINT (Ctrl-C), SIGTERM and SIGHUP end the work after its step, so that what was found is written. One that comes
// again ends the program at once.

/// Of the subcommands that do so.
inline constexpr const char* stop_footer =
    "Files take their names when they are whole; what was there before stays until then. Ctrl-C, SIGTERM and SIGHUP\n"
    "end the work after its step: what was found is written, marked as cut short, as NAME.cut where NAME exists.\n"
    "Exit status: 0 fine, 1 the run failed, 2 bad usage or input, 130, 143 or 129 ended by one of these signals.";

/// From here on. A signal that was ignored when the program began, as SIGHUP is under nohup, stays so.
void listen_for_stop();

/// The first that came; 0: none.
int stop_signal();

/// "SIGINT".
std::string stop_name();
