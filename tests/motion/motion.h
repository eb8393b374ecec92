// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tests/holds/hold.h>

#include <vector>

namespace raycontact::scenes {

/// Scenes of bodies in motion with an answer on paper. Nothing rests at the end; each Hold's figures are its verdict.
/// In the order in which docs/internals/bullet-measurements.md has them.
std::vector<Hold> all_motions();

} // namespace raycontact::scenes
