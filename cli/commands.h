// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

// Each adds a subcommand of the program; docs/program.md says what they do.
void add_clash(CLI::App& app);
void add_collide(CLI::App& app);
void add_devices(CLI::App& app);
void add_mesh(CLI::App& app);
void add_replay(CLI::App& app);
void add_reproduce(CLI::App& app);
void add_run(CLI::App& app);
void add_samples(CLI::App& app);
void add_view(CLI::App& app);

/// Adds every one.
void add_commands(CLI::App& app);
