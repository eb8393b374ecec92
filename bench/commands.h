// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

// The subcommands of raycontact-bench. Each is in a file of its name, where nothing else is said.
namespace raycontact::bench {

void add_peers(CLI::App& app);
void add_growth(CLI::App& app); ///< in peers.cpp
void add_device(CLI::App& app);
void add_queries(CLI::App& app);
void add_rays(CLI::App& app);
void add_stacks(CLI::App& app);
void add_holds(CLI::App& app);
void add_motion(CLI::App& app); ///< in holds.cpp
void add_clash(CLI::App& app);
void add_scale(CLI::App& app);
void add_threads(CLI::App& app);
void add_new_shape(CLI::App& app);
void add_factory(CLI::App& app);

} // namespace raycontact::bench
