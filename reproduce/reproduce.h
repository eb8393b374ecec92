// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <reproduce/experiment.h>
#include <reproduce/number.h>
#include <reproduce/plan.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace raycontact::reproduce {

struct Options {
    Plan plan;
    std::filesystem::path out;
    std::string what = "all"; ///< or the name of an experiment
    /// Told that an experiment begins, and how many rough milliseconds of new work it has: 0 if all is kept from
    /// before.
    std::function<void(const std::string& experiment, std::uint32_t total)> begin;
    std::function<void(std::uint32_t done)> progress;
    std::function<void()> end;
    /// May be empty. Given the tables of the experiment, if `what` is one.
    std::function<void(const Table&)> table;
};

/// "all" and the names of the experiments.
std::vector<std::string> experiment_names();

/// Runs what is not yet in out/cache; then writes out/results.json and out/report.html about every experiment whose
/// results are there, those of earlier calls with the same plan included. Returns what results.json lists. Throws
/// InputError for an unknown experiment or a folder that cannot be written.
std::vector<Number> reproduce(const Options& options);

} // namespace raycontact::reproduce
