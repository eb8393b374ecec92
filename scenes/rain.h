// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/description.h>

#include <cstdint>
#include <string>

namespace raycontact::scenes {

/// The paper's second scene (section 5.1, Figure 8): a source that moves on a circle lets go ten bodies a second, of
/// four concave shapes in turn, of 902, 2130, 3456 and 3458 triangles. The paper states neither circle and height nor
/// the shapes and their sizes. Ours: a bunny, a torus, a star and a knot, each 1 m large, from 7 m above the ground,
/// and a circle on which the next body does not meet the last; 9 800 to 10 200 pairs of boxes overlap at the end.
/// Ground as in the avalanche; its body is the first.
struct RainOptions {
    std::uint32_t bodies = 500;  ///< at most; those that come after the planned steps are left out
    std::uint32_t steps = 3000;  ///< planned, of 1/60 s
    std::uint64_t seed = 1;      ///< of the bodies' first rotations
    std::string model = "bunny"; ///< of the shape of 902 triangles, see scene_model; the others are procedural
    double rate = 10;            ///< bodies a second
    double radius = 2.5;         ///< of the source's circle, metres
    double height = 7;           ///< of the source above the ground, metres
    double period = 1.3;         ///< of the source, seconds a turn
    double density = 1000;       ///< kg/m^3
    Settings settings;           ///< of RayContact
    Response response;
};

/// Throws InputError for options out of range.
SceneDescription rain(const RainOptions& options);

} // namespace raycontact::scenes
