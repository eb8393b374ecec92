// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/results.h>
#include <cli/number_option.h>
#include <cli/out_option.h>
#include <cli/stop.h>
#include <output/out_folder.h>
#include <raycontact/error.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <iostream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// An option of words with commas between them, out of those that are known.
inline void add_words(CLI::App& command, const std::string& option, std::vector<std::string>& words,
                      const std::vector<std::string>& known, const std::string& help) {
    const auto check = [option, known](const std::string& word) -> std::string {
        if (std::ranges::find(known, word) != known.end()) return "";
        std::string all;
        for (const std::string& one : known) all += (all.empty() ? "" : ", ") + one;
        throw InputError(option + ": \"" + word + "\" is not known; choose from " + all);
    };
    command.add_option(option, words, help)->type_name("WORDS")->delimiter(',')->check(check);
}

/// The same of values that have words.
template <class Value>
void add_values(CLI::App& command, const std::string& option, std::vector<Value>& values,
                Value (*from)(std::string_view), const std::string& help) {
    const auto read = [&values, from](const std::vector<std::string>& words) {
        values.clear();
        for (const std::string& word : words) values.push_back(from(word));
    };
    command.add_option_function<std::vector<std::string>>(option, read, help)->type_name("WORDS")->delimiter(',');
}

inline void add_json(CLI::App& command, bool& json) {
    command.add_flag("--json", json, "print one JSON object on stdout");
}

/// Of worlds that run by finders in turn.
inline void add_world_options(CLI::App& command, double& seconds, std::string& only, std::string& finder,
                              const std::string& finders) {
    add_number(command, "--seconds", seconds, "of a run, at most", 1e-3, 1e6)->type_name("S");
    command.add_option("--only", only, "those with this in their name")->type_name("TEXT");
    command.add_option("--finder", finder, "this one alone: " + finders)->type_name("WORD");
}

/// What a benchmark prints, and what it writes with --out: DIR/<machine>/<name>-<date>, claimed before it begins.
class Output {
public:
    Output(const std::string& out, std::initializer_list<const char*> names,
           std::initializer_list<const char*> endings = {".csv", ".svg"}) {
        listen_for_stop();
        if (out.empty()) return;
        folder_.emplace(std::filesystem::path(out) / machine.slug);
        for (const char* name : names)
            for (const char* ending : endings) folder_->claim(file(name, ending));
        name_left_overs(folder_->left_overs());
    }

    /// The machine as it is at the end. False where a signal came before anything was measured.
    bool finish(bool anything = true) {
        machine.load = report::this_machine().load;
        machine.cut_short = bench_stopped;
        tell("");
        if (bench_stopped) std::cerr << "cut short by " << stop_name() << '\n';
        return anything || !bench_stopped;
    }
    /// The machine comes first in both.
    void print(bool json, const std::string& table, const Json& object) const {
        Json whole{{"machine", machine_json(machine)}};
        whole.update(object);
        // Drivers choose their own names: what is not UTF-8 in them must not end the program.
        std::cout << (json ? whole.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"
                           : heading(machine) + table)
                  << std::flush;
    }
    void write(const std::string& name, const std::string& ending, const std::string& text) {
        if (folder_) folder_->write(file(name, ending), text);
    }
    void keep() {
        if (!folder_) return;
        for (const auto& kept : folder_->keep(machine.cut_short)) std::cerr << "written: " << kept.string() << '\n';
    }

    Machine machine = report::this_machine();

private:
    std::string file(const std::string& name, const std::string& ending) const {
        return name + "-" + machine.date + ending;
    }

    std::optional<output::OutFolder> folder_;
};

} // namespace raycontact::bench
