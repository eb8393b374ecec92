// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

/// `raycontact run SCENE [--steps N] [--bodies N] [--seed S] [--record FILE] [--out DIR] [--json]` and the common
/// options.
void add_run(CLI::App& app);
