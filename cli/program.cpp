// SPDX-License-Identifier: Apache-2.0
#include "cli/program.h"

#include "cli/stop.h"
#include "cli/suggest.h"

#include <raycontact/error.h>

#include <LinearMath/btAlignedAllocator.h>

#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <stdexcept>
#include <string>

namespace {

/// Bullet would use what it did not get.
void* allocate_or_throw(std::size_t size) {
    void* memory = std::malloc(size);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

std::string names(const CLI::App& app) {
    std::string list;
    const auto commands = app.get_subcommands({});
    for (std::size_t i = 0; i < commands.size(); ++i)
        list += (i == 0 ? "" : i + 1 < commands.size() ? ", " : " or ") + commands[i]->get_name();
    return list;
}

int run(const Program& program, int argc, char** argv) {
    const std::string name = program.name, see = " (see " + name + " --help)";
    CLI::App app{program.description, name};
    app.set_version_flag("--version", name + " " RAYCONTACT_VERSION);
    app.require_subcommand(0, 1); // none is refused below: CLI11 would not name a misspelt one
    app.footer(program.footer);
    program.add_commands(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ExtrasError&) {
        complain(name, what_was_not_expected(app) + see);
        return bad_input;
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error); // --help and --version
        complain(name, error.what() + see);
        return bad_input;
    }
    if (app.get_subcommands().empty()) throw raycontact::InputError("a subcommand is required: " + names(app) + see);
    if (!std::cout.flush()) throw std::runtime_error("standard output cannot be written");
    return stop_signal() == 0 ? fine : 128 + stop_signal(); // as a shell has it
}

} // namespace

void complain(std::string_view program, std::string_view message) {
    std::string line = std::string(program) + ": ";
    for (const char c : message) line += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
    std::cerr << line << '\n';
}

int run_program(const Program& program, int argc, char** argv) {
    std::signal(SIGXFSZ, SIG_IGN); // a file that may not grow is then an error like a full disk
    btAlignedAllocSetCustom(allocate_or_throw, std::free);
    try {
        return run(program, argc, argv);
    } catch (const EndWith& end) {
        return std::cout.flush() ? end.status : failed;
    } catch (const raycontact::InputError& error) {
        complain(program.name, error.what());
        return bad_input;
    } catch (const std::bad_alloc&) {
        complain(program.name, "not enough memory");
    } catch (const std::exception& error) {
        complain(program.name, error.what());
    }
    return failed;
}
