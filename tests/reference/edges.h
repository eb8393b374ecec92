// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/contacts.h"

#include <raycontact/settings.h>

#include <vector>

namespace raycontact::reference {

/// The contacts of edges of a pair of bodies (0, 1), and of a body inside another: docs/internals/edges.md in double
/// and by brute force, every edge against every face and every ray against every triangle. Vertex contacts, which it
/// takes part in deciding by, are the reference's own and not among the result. In the order of the contract.
std::vector<ReferenceContact> find_edges(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b,
                                         Direction direction = Direction::reprojected);

} // namespace raycontact::reference
