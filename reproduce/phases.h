// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <reproduce/series.h>

#include <vector>

namespace raycontact::reproduce {

/// Of the paper's Figure 11: B, most pairs are cast in full; C, most are updated.
enum class Phase { b, c };

/// Of each step. A second (60 steps) is of phase B if its share of ordered pairs tested in full lies above the
/// middle between the least and the largest share of the seconds that have pairs, or if all have the same; others are
/// C.
std::vector<Phase> phases(const Series& full, const Series& ordered_pairs);

/// The first's time over the second's, in that phase; over all steps where there is no such step. Always finite.
double speed_up(const Series& first_ms, const Series& second_ms, const std::vector<Phase>& phase, Phase which);

constexpr std::size_t second = 60; ///< steps

/// The same in the second that begins with this step.
double of_second(const Series& first_ms, const Series& second_ms, std::size_t from);
/// The largest of these.
double best_second(const Series& first_ms, const Series& second_ms);

} // namespace raycontact::reproduce
