// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>
#include <raycontact/pose.h>

#include <array>
#include <cstdint>
#include <span>

namespace raycontact {

/// Of a body filled with matter of unit density.
struct Mass {
    double volume = 0;               ///< m^3; times the density it is the mass
    Vec3 centre;                     ///< of mass, body frame, metres
    std::array<double, 9> inertia{}; ///< about the centre, body axes, row-major, m^5; times the density it is kg m^2
};

/// By volume integrals over a closed mesh, exact but for rounding wherever it lies; all 0 where it encloses nothing.
/// Volume and inertia are negative for one that is wound inward. Every index must be one of a vertex.
RAYCONTACT_API Mass mass_of(std::span<const Vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles);

} // namespace raycontact
