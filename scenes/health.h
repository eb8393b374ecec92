// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace raycontact::scenes {

/// How well the bodies of a run behave; over the whole run unless said otherwise.
struct Health {
    double penetration_max = 0;               ///< deepest contact, metres
    double depth_limit = 0;                   ///< SceneDescription::depth_limit
    std::uint64_t deep_contacts = 0;          ///< contacts deeper than the limit, summed over the steps
    std::uint32_t deep_steps_longest = 0;     ///< most steps in a row that one contact (same key) was deeper
    std::uint32_t deep_steps_last_second = 0; ///< the same, of runs that reach into the last second
    double median_speed_last_second = 0;      ///< median over bodies, the largest of the last second's steps, m/s
    std::uint32_t below_ground = 0;           ///< bodies whose centre of mass is under the region now
    std::uint32_t flown_off = 0;              ///< bodies beside or above the region now
};

} // namespace raycontact::scenes
