// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"
#include "cli/complain.h"
#include "cli/exit_status.h"
#include "cli/stop.h"
#include "cli/suggest.h"

#include <raycontact/error.h>

#include <CLI/CLI.hpp>
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

int run_program(int argc, char** argv) {
    CLI::App app{"RayContact finds the contacts between moving, concave triangle meshes by casting rays.",
                 "raycontact"};
    app.set_version_flag("--version", "raycontact " RAYCONTACT_VERSION);
    app.require_subcommand(0, 1); // none is refused below: CLI11 would not name a misspelt one
    app.footer(
        "Exit status: 0 fine, 1 the run failed, 2 bad usage or input, 3 a check found something, 130 ended by Ctrl-C.");
    add_commands(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ExtrasError&) {
        complain(what_was_not_expected(app) + " (see raycontact --help)");
        return bad_input;
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error); // --help and --version
        complain(std::string(error.what()) + " (see raycontact --help)");
        return bad_input;
    }
    if (app.get_subcommands().empty()) {
        throw raycontact::InputError(
            "a subcommand is required: devices, samples, mesh, collide, clash, run, replay, view, "
            "reproduce or bench (see raycontact --help)");
    }
    if (!std::cout.flush()) throw std::runtime_error("standard output cannot be written");
    return stop_signal() == 0 ? fine : 128 + stop_signal(); // as a shell has it
}

} // namespace

int main(int argc, char** argv) {
    std::signal(SIGXFSZ, SIG_IGN); // a file that may not grow is then an error like a full disk
    btAlignedAllocSetCustom(allocate_or_throw, std::free);
    try {
        return run_program(argc, argv);
    } catch (const EndWith& end) {
        return std::cout.flush() ? end.status : failed;
    } catch (const raycontact::InputError& error) {
        complain(error.what());
        return bad_input;
    } catch (const std::bad_alloc&) {
        complain("not enough memory");
    } catch (const std::exception& error) {
        complain(error.what());
    }
    return failed;
}
