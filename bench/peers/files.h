// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/machine.h>

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <string>

// What every table, CSV and JSON of the benchmarks begins with.
namespace raycontact::bench {

/// One line for a person.
std::string heading(const Machine& machine);
nlohmann::ordered_json machine_json(const Machine& machine);
/// The first columns of every CSV.
inline constexpr const char* machine_columns = "date,commit,cpu,cores,compiler,governor,load";
std::string machine_fields(const Machine& machine);
/// A field that may hold commas.
std::string quoted(const std::string& text);

/// DIR/<machine>/<name>-<date>.csv; the folders are made where missing. Returns its path. Throws InputError naming what
/// cannot be written.
std::filesystem::path write_csv(const std::filesystem::path& folder, const Machine& machine, const std::string& name,
                                const std::string& csv);
/// The same, and a chart: .svg.
std::filesystem::path write_both(const std::filesystem::path& folder, const Machine& machine, const std::string& name,
                                 const std::string& csv, const std::string& svg);

} // namespace raycontact::bench
