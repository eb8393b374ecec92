// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/directed_pairs.h"

#include <raycontact/contact.h>

namespace raycontact {

/// With speculative contacts: of contacts of one direction of a pair that are no deeper than the margin, the face that
/// stops the vertex with the least change of its motion (docs/internals/speculative.md). In double on the host.
class LowSteps {
public:
    LowSteps(const Settings& settings, const PlacedBody& source, const PlacedBody& target);
    /// Whether a vertex may go farther than the margin until the next step; others change nothing.
    bool moves() const { return moves_; }
    /// Sets triangle, normal and depth of a contact that was placed. triangle: of the target, as it is prepared.
    void step_over(Contact& contact, std::uint32_t vertex, std::uint32_t triangle) const;

private:
    const PlacedBody &source_, &target_;
    double margin_;
    Pose now_{}, next_{}; ///< of the source's centred frame in the target's
    bool moves_ = false;
};

} // namespace raycontact
