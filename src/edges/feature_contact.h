// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"

#include <raycontact/contact.h>

namespace raycontact {

/// A contact of an edge, or of a body inside another; in the target's centred frame.
struct FeatureContact {
    VertexBody source;
    Feature feature;
    std::uint32_t index;    ///< edge: 3 x its lowest triangle + its first corner; inside: the vertex; of the shape
    std::uint32_t crossing; ///< Contact::crossing
    std::uint32_t face;     ///< of the target
    Vec3 point;
    Vec3 normal; ///< out of the target, unit
    double depth;
};

} // namespace raycontact
