// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace raycontact::scenes {

/// How well the bodies of a run behave; over the whole run unless said otherwise.
struct Health {
    double penetration_max = 0;               ///< deepest contact, metres
    double depth_limit = 0;                   ///< SceneDescription::depth_limit
    std::uint64_t deep_contacts = 0;          ///< contacts deeper than the limit, summed over the steps
    std::uint32_t deep_steps_longest = 0;     ///< most steps in a row that one contact (same key) was deeper
    std::uint32_t deep_steps_last_second = 0; ///< the same, of runs that reach into the last second
    double median_speed_last_second = 0; ///< over the bodies, and of these medians over the last second's steps, m/s
    /// Bodies whose centre of mass is now under the region, and beside or above it; one that fell past an edge is both.
    /// Nothing where the scene has no ground.
    std::optional<std::uint32_t> below_ground, flown_off;
};

} // namespace raycontact::scenes
