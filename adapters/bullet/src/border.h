// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <objects.h>

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact::bullet {

/// Where the border of an open mesh is in a convex shape, or comes to it. World frame, metres.
struct BorderContact {
    int edge;          ///< of the mesh, as of contacts of edges
    int end;           ///< of what is inside: 0 or 1
    btVector3 point;   ///< of the edge, where it is now
    btVector3 normal;  ///< unit, out of the convex shape
    btScalar distance; ///< negative: the depth
};

/// margin: metres. Of those edges of the border (3 t + k) that the convex shape has within `margin`, or meets before the next dispatch:
/// either end of what is inside. They leave by the face that is nearest there, or by one that is no farther than the
/// margin and that the motion passes far less.
void border_contacts(const Leaf& convex, const Leaf& mesh, std::span<const std::uint32_t> edges, double margin,
                     std::vector<BorderContact>& found);

} // namespace raycontact::bullet
