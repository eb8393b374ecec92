// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/entrants.h>
#include <bench/peers/results.h>

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace raycontact::bench {

/// Our methods that the others are compared with, besides `bvh`.
inline constexpr std::array<const char*, 3> coherent_methods{"iterative", "predictive", "certified"};

/// One entrant's figures on one work. Times are of the processor (one thread each), so that other programs on the
/// machine disturb them least; wall times are kept beside them. All are medians over the runs.
struct Result {
    std::string work, peer, what;
    bool rays_alone = false;
    std::uint32_t steps = 0;      ///< given to it
    std::uint64_t pair_steps = 0; ///< in these
    double us = 0, wall_us = 0;   ///< a pair and step, microseconds
    double ratio = 0; ///< its time over ours (bvh, or our rays) on the steps both were given; 0 where ours did not run
    std::array<double, 3> method_ratios{}; ///< the same over coherent_methods
    std::uint64_t rays = 0, contacts = 0;
    double depth_sum = 0;
    std::uint64_t memory_bytes = 0; ///< in use more than before it was made, warm; own count where it has one
    bool memory_is_own_count = false;
    // Of ours only:
    std::string hash;   ///< of the steps given
    bool agrees = true; ///< every step's hash is that of `bvh`, where both have one and must agree
    StepStats sums;     ///< over its steps; pair_bytes is the most of a step
    std::optional<recording::WrongRays> wrong; ///< against `standard`, every ray cast
};

/// Every entrant over its steps, one after the other, `runs` times: A B C A B C. Ours go once more beforehand, when
/// their contacts are compared. `progress` is told what is next.
std::vector<Result> contest(const Work& work, const std::vector<Entrant>& entrants, std::uint32_t runs,
                            const Progress& progress);

/// For a person; `works` are notes.
std::string table(const Json& works, std::span<const Result> results);
Json json(const Result& result);
/// Of the CSV: those of earlier results come first, so that both can be read alike.
inline constexpr const char* result_columns =
    "work,source,peer,what,steps,pair_steps,us_per_pair_step,wall_us_per_pair_step,times_ours,rays,contacts,"
    "memory_bytes,memory_count,hash,times_iterative,times_predictive,times_certified,pace_median,pace_most,rays_cast,"
    "walks,walks_lost,pairs_full,pair_bytes,missed,invented,other_triangle,wrong,rays_compared,contacts_compared";
std::string chart(const Json& works, std::span<const Result> results);

} // namespace raycontact::bench
