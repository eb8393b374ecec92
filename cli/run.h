// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

/// `raycontact run SCENE|FILE.json|--mesh FILE... [--steps N] [--bodies N] [--seed S] [--record FILE] [--out DIR]
/// [--json]` and the common options.
void add_run(CLI::App& app);
