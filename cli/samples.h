// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

void add_samples(CLI::App& app);
