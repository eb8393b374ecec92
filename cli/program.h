// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <string_view>

/// A program of subcommands.
struct Program {
    const char *name, *description, *footer;
    void (*add_commands)(CLI::App& app);
};

/// `found`: a check that was asked for found something; nothing went wrong.
enum ExitStatus : int { fine = 0, failed = 1, bad_input = 2, found = 3 };

/// Thrown by a subcommand that has said all there is to say.
struct EndWith {
    ExitStatus status;
};

/// One line on stderr, whatever a file name or a library put into the message.
void complain(std::string_view program, std::string_view message);

/// Its main(): reads the command line, runs what it asks for, says in one line what went wrong; the exit status.
int run_program(const Program& program, int argc, char** argv);
