// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

/// Registers `collide`: the contacts of pairs of mesh files, on stdout; all input is checked before any output.
void add_collide(CLI::App& app);
