// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

/// `raycontact reproduce`: the paper's figures and tables.
void add_reproduce(CLI::App& app);
