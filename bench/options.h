// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/files.h>
#include <bench/peers/stopped.h>
#include <cli/number_option.h>
#include <cli/out_option.h>
#include <cli/stop.h>

#include <CLI/CLI.hpp>

#include <initializer_list>
#include <iostream>
#include <optional>
#include <string>

#include <unistd.h>

// What the subcommands share.
namespace raycontact::bench {

/// Whether a signal ended the benchmark before its last row.
inline bool bench_stopped = false;

/// Throws Stopped where a signal has come.
inline void end_if_stopped() {
    if (stop_signal() == 0) return;
    bench_stopped = true;
    throw Stopped();
}

/// One line that says what is being done, on a terminal only. Throws Stopped where a signal has come.
inline void tell(const std::string& what) {
    if (!what.empty()) end_if_stopped();
    if (isatty(STDERR_FILENO)) std::cerr << "\r\033[K" << what << std::flush;
}

/// Does the work, as far as it gets.
template <class Do>
void until_stopped(Do work) {
    try {
        work();
    } catch (const Stopped&) {
        // What is whole is written.
    }
}

/// The machine as it is at the end.
inline void finish(Machine& machine) {
    machine.load = this_machine().load;
    machine.cut_short = bench_stopped;
    tell("");
    if (bench_stopped) std::cerr << "cut short by " << stop_name() << '\n';
}

/// Of worlds that run by finders in turn.
inline void add_world_options(CLI::App& command, double& seconds, std::string& only, std::string& finder,
                              const std::string& finders) {
    add_number(command, "--seconds", seconds, "of a run, at most", 1e-3, 1e6)->type_name("S");
    command.add_option("--only", only, "those with this in their name")->type_name("TEXT");
    command.add_option("--finder", finder, "this one alone: " + finders)->type_name("WORD");
}

/// What a benchmark writes with --out: DIR/<machine>/<name>-<date>, claimed before it begins. Without --out nothing.
class BenchFiles {
public:
    BenchFiles(const std::string& out, const Machine& machine, std::initializer_list<const char*> names,
               std::initializer_list<const char*> endings = {".csv", ".svg"}) {
        listen_for_stop();
        if (out.empty()) return;
        folder_.emplace(results_folder(out, machine));
        for (const char* name : names)
            for (const char* ending : endings) folder_->claim(result_name(machine, name, ending));
        name_left_overs(folder_->left_overs());
    }
    explicit operator bool() const { return folder_.has_value(); }
    raycontact::output::OutFolder& folder() { return *folder_; }
    void keep(const Machine& machine) {
        for (const auto& file : folder_->keep(machine.cut_short)) std::cerr << "written: " << file.string() << '\n';
    }

private:
    std::optional<raycontact::output::OutFolder> folder_;
};

} // namespace raycontact::bench
