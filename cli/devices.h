// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

/// Registers `devices`: lists what can run the kernels on this machine, on stdout.
void add_devices(CLI::App& app);
