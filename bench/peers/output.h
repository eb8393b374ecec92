// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/contest.h>
#include <bench/peers/growth.h>
#include <bench/peers/machine.h>

#include <filesystem>
#include <span>
#include <string>

namespace raycontact::bench {

/// What a work was, for a person and for the files.
struct WorkNote {
    std::string name, source;
    std::uint32_t steps = 0;
    std::uint64_t pair_steps = 0;
    Pace pace;
};

// For a person.
std::string table(const Machine& machine, std::span<const WorkNote> works, std::span<const Result> results);
std::string table(const Machine& machine, std::span<const GrowthRow> rows);
// One object.
std::string json(const Machine& machine, std::span<const WorkNote> works, std::span<const Result> results);
std::string json(const Machine& machine, std::span<const GrowthRow> rows);

/// DIR/<machine>/<name>-<date>.csv and .svg; the folders are made where missing. Returns the path of the CSV.
/// Throws InputError naming what cannot be written.
std::filesystem::path write_results(const std::filesystem::path& folder, const Machine& machine,
                                    std::span<const WorkNote> works, std::span<const Result> results);
std::filesystem::path write_results(const std::filesystem::path& folder, const Machine& machine,
                                    std::span<const GrowthRow> rows);

} // namespace raycontact::bench
