// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/description.h>
#include <scenes/random.h>

#include <cstdint>
#include <vector>

namespace raycontact::scenes {

/// A source that moves on a horizontal circle, counter-clockwise seen from above, and lets bodies go at a steady rate,
/// their shapes in turn, each turned at random.
struct CircleSource {
    std::vector<std::uint32_t> shapes; ///< indices into SceneDescription::shapes
    std::uint32_t bodies = 1;
    double rate = 10;     ///< bodies a second
    Vec3 centre{0, 0, 0}; ///< of the circle, metres
    double radius = 0;    ///< metres
    double period = 1;    ///< seconds for a turn; it starts at centre + (radius, 0, 0)
    Vec3 velocity;        ///< that each body starts with, m/s
    double density = 1000;
    std::uint32_t first_step = 0; ///< in which the first body comes

    /// The step in which body k comes.
    std::uint32_t step_of(std::uint32_t k, double dt) const;
};

/// Adds its bodies to those of the scene, as far as they come within the planned steps.
void add_source(SceneDescription& description, const CircleSource& source, Random& random);

} // namespace raycontact::scenes
