// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <output/out_folder.h>
#include <report/machine.h>

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <string>

// What every table, CSV and JSON of the benchmarks begins with.
namespace raycontact::bench {

using report::Machine;
using report::this_machine;

nlohmann::ordered_json machine_json(const Machine& machine);
/// The first columns of every CSV.
inline constexpr const char* machine_columns = "date,commit,cpu,cores,compiler,governor,load";
std::string machine_fields(const Machine& machine);
/// A field that may hold commas.
std::string quoted(const std::string& text);

/// DIR/<machine>.
std::filesystem::path results_folder(const std::filesystem::path& folder, const Machine& machine);
/// <name>-<date> and the ending.
std::string result_name(const Machine& machine, const std::string& name, const std::string& ending);
/// A table, .csv, and a chart, .svg. Throws as OutFolder::write does.
void write_both(output::OutFolder& folder, const Machine& machine, const std::string& name, const std::string& csv,
                const std::string& svg);

} // namespace raycontact::bench
