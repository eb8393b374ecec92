// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>

namespace raycontact::test {

/// What a spring and a damper at each contact answer. The contact's weight w multiplies both: with direction `weighted`
/// it is an area, so units differ.
struct Penalty {
    double stiffness = 0;     ///< N/m; N/m^3 with direction `weighted`
    double damping = 0;       ///< N s/m; N s/m^3 with direction `weighted`
    double friction = 0;      ///< coefficient of Coulomb's law
    double slip_speed = 0.01; ///< m/s, positive: a slower contact has less friction, in proportion, so it creeps
};

/// The force of a contact on its body b, newtons, world frame; a has the opposite one. velocity: of b's point minus
/// that of a's, m/s.
///
/// Along the normal w (stiffness x depth - damping x speed of parting), but never a pull; against the sliding
/// `friction` times that, by min(1, speed / slip_speed): Coulomb's law without its jump. 0 of a speculative contact.
Vec3 penalty_force(const Penalty& penalty, const Contact& contact, const Vec3& velocity = {});

} // namespace raycontact::test
