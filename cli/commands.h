// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

/// Adds every subcommand of the program.
void add_commands(CLI::App& app);
