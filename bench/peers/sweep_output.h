// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/files.h>
#include <bench/peers/notes.h>
#include <bench/peers/seeds.h>
#include <bench/peers/thresholds.h>

#include <span>
#include <string>

namespace raycontact::bench {

// For a person.
std::string table(const Machine& machine, std::span<const WorkNote> works, std::span<const ThresholdRow> rows);
std::string table(const Machine& machine, std::span<const SeedRow> rows);
/// One object; either part may be empty.
std::string json(const Machine& machine, std::span<const WorkNote> works, std::span<const ThresholdRow> thresholds,
                 std::span<const SeedRow> seeds);

/// sweep-thresholds and sweep-seeds, as write_both() does.
void write_results(output::OutFolder& folder, const Machine& machine, std::span<const WorkNote> works,
                   std::span<const ThresholdRow> rows);
void write_results(output::OutFolder& folder, const Machine& machine, std::span<const SeedRow> rows);

} // namespace raycontact::bench
