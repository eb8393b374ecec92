// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

/// A program of subcommands.
struct Program {
    const char *name, *description, *footer;
    void (*add_commands)(CLI::App& app);
};

/// Its main(): reads the command line, runs what it asks for, says in one line what went wrong; the exit status.
int run_program(const Program& program, int argc, char** argv);
