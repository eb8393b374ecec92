// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <report/plot.h>
#include <reproduce/cache.h>
#include <scenes/peers/clock.h>

#include <cstddef>
#include <string>
#include <vector>

namespace raycontact::reproduce {

using Series = std::vector<double>; ///< a number a step

double sum(const Series& values);
using peers::median;

/// Means over at most 200 windows of equal length; a point lies at its window's middle step.
report::Line line(std::string name, const Series& values);
/// 100 x part / whole, window by window.
report::Line percent_line(std::string name, const Series& part, const Series& whole);

/// Of the whole, in percent; 0 of nothing.
double share(double part, double whole);
/// By how much the second is less than the first, in percent; 0 where the first is nothing.
double less_by(double first, double second);
/// "12.3 %", with so many digits after the point.
std::string percent(double value, int digits = 1);

/// Spearman's: 1 where both rise together, however; -1 where one falls as the other rises. Equal values share the mean
/// of their ranks. 0 where either has fewer than two different values. Both have as many.
double rank_correlation(const Series& a, const Series& b);

} // namespace raycontact::reproduce
