// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <reproduce/series.h>

namespace raycontact::reproduce {

/// Spearman's: 1 where both rise together, however; -1 where one falls as the other rises. Equal values share the mean
/// of their ranks. 0 where either has fewer than two different values. Both have as many.
double rank_correlation(const Series& a, const Series& b);

} // namespace raycontact::reproduce
