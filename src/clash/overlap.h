// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clash/parts.h"

#include <optional>

namespace raycontact::clash {

/// What two parts that share a point share. Right to the perturbation of the edges' rule, 1e-7 of the smaller part
/// (docs/internals/edges.md): faces that touch do not cross.
struct Overlap {
    bool crosses = false;   ///< their surfaces do
    bool pierces = false;   ///< ClashKind::piercing
    bool inside = false;    ///< ClashKind::inside
    std::optional<Box> box; ///< Clash::box
};
Overlap overlap_of(const Part& a, const Part& b);

} // namespace raycontact::clash
