// SPDX-License-Identifier: Apache-2.0
#include "penalty.h"

#include "mesh/vector.h"

#include <algorithm>

namespace raycontact::test {

Vec3 penalty_force(const Penalty& penalty, const Contact& contact, const Vec3& velocity) {
    if (contact.is_speculative()) return {};
    const Vec3 normal = contact.normal;
    const double parting = dot(velocity, normal);
    const double pressed = static_cast<double>(contact.weight)
                           * (penalty.stiffness * static_cast<double>(contact.depth) - penalty.damping * parting);
    if (!(pressed > 0)) return {}; // a damper would pull a body back that leaves fast
    const Vec3 sliding = velocity - parting * normal;
    return pressed * normal - (penalty.friction * pressed / std::max(length(sliding), penalty.slip_speed)) * sliding;
}

} // namespace raycontact::test
