// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>
#include <raycontact/mass.h>
#include <raycontact/shape.h>

namespace raycontact::bullet {

/// The mass properties of a solid body of unit density.
struct MassProperties : Mass {
    Pose principal;         ///< frame at the centre whose axes are the principal ones, seen from the body frame
    Vec3 principal_inertia; ///< about those axes, m^5
};

/// By volume integrals for a closed mesh of positive volume; those of its box for any other.
RAYCONTACT_API MassProperties mass_properties(const Shape& shape);

} // namespace raycontact::bullet
