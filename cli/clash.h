// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

/// `raycontact clash`: which parts of an assembly intersect.
void add_clash(CLI::App& app);
