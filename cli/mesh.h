// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

/// Registers `mesh`: what a mesh file holds and which repairs it needs, on stdout.
void add_mesh(CLI::App& app);
