// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/near_edges.h"
#include "speculative/speculative_pair.h"

#include <span>
#include <vector>

namespace raycontact {

/// Adds the speculative contacts of two edges in any order, but for those that `found` has already
/// (docs/internals/speculative.md). least: metres; edges that hide less are left out.
void find_speculative_edges(const SpeculativePair& pair, const NearEdges& near, double least,
                            std::vector<FeatureContact>& found);

/// Of two edges that touch, no deeper than the margin: what averts that and changes the motion least.
void change_least(const SpeculativePair& pair, FeatureContact& contact);

} // namespace raycontact
