// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tests/holds/hold.h>

namespace raycontact::scenes {

std::vector<Hold> standing();     ///< columns, a wall, an arch, what is heavy on what is light
std::vector<Hold> heaps();        ///< a bowl, a bin, a thousand tori
std::vector<Hold> contraptions(); ///< a hand, a foil, chains, gears, a mug
std::vector<Hold> fits();         ///< a peg in its hole, a nut on its bolt

inline Pose at(double x, double y, double z) {
    return {.translation = {x, y, z}};
}
/// `turns` about an axis, a unit vector.
Pose turned_at(const Vec3& place, const Vec3& axis, double turns);

} // namespace raycontact::scenes
