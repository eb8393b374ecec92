// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/description.h>

#include <cstdint>
#include <string>

namespace raycontact::scenes {

/// The paper's first scene (section 5.1): concave meshes in a cubic grid fall onto the ground and pile up.
/// z is up, gravity 9.81 m/s^2; the ground is a closed slab whose top is z = 0. Its body is the last.
struct AvalancheOptions {
    std::uint32_t bodies = 512;    ///< grid of ceil(cbrt(bodies)) a side, filled from below
    std::uint32_t steps = 600;     ///< planned, of 1/60 s
    std::uint64_t seed = 1;        ///< of the small offsets and tilts
    std::string model = "bunny";   ///< see scene_model
    std::uint32_t triangles = 902; ///< of each body; its largest extent is 1 m
    double spacing = 1.05;         ///< of the grid, metres
    double density = 1000;         ///< kg/m^3
    Settings settings;             ///< of RayContact
    Response response;
};

/// Throws InputError for options out of range.
SceneDescription avalanche(const AvalancheOptions& options);

} // namespace raycontact::scenes
