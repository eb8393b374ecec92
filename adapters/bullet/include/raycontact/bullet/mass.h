// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mass.h>
#include <raycontact/shape.h>

namespace raycontact::bullet {

/// Of a body filled with matter of unit density.
struct MassProperties : Mass {
    Pose principal;         ///< frame at the centre whose axes are the principal ones, seen from the body frame
    Vec3 principal_inertia; ///< about those axes, m^5
};

/// By volume integrals for a closed mesh of positive volume; of the box around it for any other.
MassProperties mass_properties(const Shape& shape);

} // namespace raycontact::bullet
