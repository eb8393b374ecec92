// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"
#include "cli/program.h"

int main(int argc, char** argv) {
    const Program program{
        "raycontact", "RayContact finds the contacts between moving, concave triangle meshes by casting rays.",
        "Exit status: 0 fine, 1 the run failed, 2 bad usage or input, 3 a check found something, 130 ended by Ctrl-C.",
        add_commands};
    return run_program(program, argc, argv);
}
