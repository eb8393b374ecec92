// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/scene.h>

namespace raycontact::bench {

/// Adds the counts of a step; pair_bytes becomes the most of a step.
void add(StepStats& sums, const StepStats& step);

} // namespace raycontact::bench
