// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>
#include <raycontact/shape.h>

#include <array>

namespace raycontact::bullet {

/// Of a body filled with matter of unit density.
struct MassProperties {
    double volume = 0;               ///< m^3; times the density it is the mass
    Vec3 centre;                     ///< of mass, body frame, metres
    std::array<double, 9> inertia{}; ///< about the centre, body axes, row-major, m^5; times the density it is kg m^2
    Pose principal;         ///< frame at the centre whose axes are the principal ones, seen from the body frame
    Vec3 principal_inertia; ///< about those axes, m^5
};

/// By volume integrals for a closed mesh of positive volume; of the box around it for any other.
MassProperties mass_properties(const Shape& shape);

} // namespace raycontact::bullet
