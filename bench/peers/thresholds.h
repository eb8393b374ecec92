// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/results.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace raycontact::bench {

/// One method at one displacement threshold, over all steps of a work.
struct ThresholdRow {
    std::string work;
    Method method = Method::standard;
    std::optional<double> fraction; ///< of body_size(); empty: chosen by the library (`standard` has none)
    double size = 0;                ///< body_size(), metres
    std::uint32_t steps = 0;
    std::uint64_t pair_steps = 0;
    double us = 0, wall_us = 0; ///< a step, microseconds of one thread: the median run
    StepStats sums;             ///< over the steps; pair_bytes is the most of a step
    recording::WrongRays wrong; ///< against `standard`, every ray cast
};

struct ThresholdOptions {
    std::uint32_t values = 10; ///< from 1e-4 to 1e-1 of the size, evenly on a logarithmic scale
    std::uint32_t runs = 3;    ///< of all settings in turn
};

/// `standard`; then iterative, predictive and certified at every value and as the library chooses.
std::vector<ThresholdRow> sweep_thresholds(const Work& work, const ThresholdOptions& options, const Progress& progress);

/// How the library's choice compares with a threshold fixed for the whole work, known only afterwards.
struct Verdict {
    std::string work;
    Method method = Method::standard;
    const ThresholdRow* chosen = nullptr;   ///< by the library
    const ThresholdRow* fastest = nullptr;  ///< of the fixed values
    const ThresholdRow* as_right = nullptr; ///< the fastest of those with no more wrong rays; none where there is none
    const ThresholdRow* rightest = nullptr; ///< with the fewest wrong rays, of these the fastest
};

std::vector<Verdict> verdicts(std::span<const ThresholdRow> rows);

/// For a person; `works` are notes.
std::string table(const Json& works, std::span<const ThresholdRow> rows);
Json json(const ThresholdRow& row);
Json json(const Verdict& verdict);
/// Of the CSV, before count_columns.
inline constexpr const char* threshold_columns =
    "work,source,pace_median,pace_most,size_m,method,threshold,steps,pair_steps,us_per_step,wall_us_per_step";
std::string chart(const Json& works, std::span<const ThresholdRow> rows);

} // namespace raycontact::bench
