// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/results.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace raycontact::bench {

// Fixed before anything was measured, so that no result chose its own setting (the paper names no values): a pair is
// tested in full when it has moved 1 % of a body's size, and predictive rays look twice that far.
inline constexpr double fixed_displacement = 0.01; ///< of the largest extent of a body's box
inline constexpr double fixed_confidence = 2;

/// What one method got wrong over the avalanche of one seed.
struct SeedRow {
    std::uint64_t seed = 0;
    Method method = Method::iterative;
    bool fixed = false;          ///< at the constants above; else as the library chooses
    bool cast_lost_walks = true; ///< Settings; `predictive` alone looks at it
    std::uint32_t steps = 0;
    StepStats sums;             ///< over the steps; pair_bytes is the most of a step
    recording::WrongRays wrong; ///< against `standard`, every ray cast
};

struct SeedOptions {
    std::uint64_t first = 1; ///< seed; the others follow it
    std::uint32_t count = 5;
    std::uint32_t bodies = 512, steps = 600; ///< of the avalanche
};

/// Every avalanche is simulated with the contacts of `certified`; the methods watch it.
/// Where `progress` throws Stopped, the seeds before.
std::vector<SeedRow> sweep_seeds(const SeedOptions& options, const Progress& progress);

/// How much fewer rays `predictive` got wrong than `iterative`: 1 - predictive / iterative.
struct Reduction {
    bool fixed = false, cast_lost_walks = true;
    std::vector<double> of_seeds; ///< those where `iterative` got any wrong
    double median = 0, least = 0, most = 0;
};

std::vector<Reduction> reductions(std::span<const SeedRow> rows);

/// For a person.
std::string table(std::span<const SeedRow> rows);
Json json(const SeedRow& row);
Json json(const Reduction& reduction);
/// Of the CSV, before count_columns.
inline constexpr const char* seed_columns = "seed,method,setting,cast_lost_walks,steps";
std::string chart(std::span<const SeedRow> rows);

} // namespace raycontact::bench
