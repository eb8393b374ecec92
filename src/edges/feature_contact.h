// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"

#include <raycontact/contact.h>

namespace raycontact {

/// A contact of two edges, or of a body inside another; in the target's centred frame. Of edges the source is a.
struct FeatureContact {
    VertexBody source;
    Feature feature;
    std::uint32_t index; ///< edges: the edge of a, 3 x its lowest triangle + its first corner; inside: the vertex
    std::uint32_t other; ///< edges: the edge of b; inside: the face of the target
    Vec3 point;          ///< on the source
    Vec3 normal;         ///< out of the target, unit
    double depth;
};

} // namespace raycontact
