// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <LinearMath/btVector3.h>

#include <vector>

namespace raycontact::bullet {

/// A point that may become part of a manifold.
struct Applicant {
    btVector3 position; ///< world, metres
    btScalar depth;     ///< metres
    bool present;       ///< it was part of one in the step before
};

/// Picks at most four: the deepest, then those that span the largest area. Points already present have an advantage, so
/// that a body at rest does not change its points every step. Ties go to the lower index. Indices come back ascending.
std::vector<int> choose_points(const std::vector<Applicant>& applicants);

} // namespace raycontact::bullet
