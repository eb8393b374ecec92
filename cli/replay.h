// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

/// `raycontact replay RECORDING [--compare standard] [--out DIR] [--json]` and the common options.
void add_replay(CLI::App& app);
