// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

void add_commands(CLI::App& app) {
    add_devices(app);
    add_samples(app);
    add_mesh(app);
    add_collide(app);
    add_clash(app);
    add_run(app);
    add_replay(app);
    add_view(app);
    add_reproduce(app);
}
