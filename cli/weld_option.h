// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/number_option.h"

/// Adds --weld, metres; empty where it is not given. `length` must outlive the command line.
inline CLI::Option* add_weld_option(CLI::App& command, std::optional<double>& length) {
    return add_number(command, "--weld", length,
                      "join vertices that are nearer to each other than this, metres; `raycontact mesh` proposes it",
                      1e-12, 1e9);
}
