// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <array>
#include <cstdint>
#include <span>

namespace raycontact::scenes {

/// Of a solid of density 1 kg/m^3 bounded by a closed, outward mesh; multiply volume and inertia by the density.
struct MassProperties {
    double volume = 0;               ///< m^3
    Vec3 centre;                     ///< centre of volume, body frame, metres
    std::array<double, 9> inertia{}; ///< tensor about `centre`, body axes, row-major, kg m^2 (diagonal: moments)
};

/// Throws InputError when the mesh is not closed and outward or encloses no volume: it has no inside then.
MassProperties mass_properties(const PreparedMesh& mesh);

/// The same for triangles that are known to be closed and outward; volume 0 and nothing else when they enclose nothing.
MassProperties mass_of_solid(std::span<const Vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles);

} // namespace raycontact::scenes
