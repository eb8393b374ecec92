// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

/// Registers `bench` and its subcommands: what contacts cost here and elsewhere, and how that grows.
void add_bench(CLI::App& app);
