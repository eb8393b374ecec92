// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace raycontact::scenes {

/// A regular polygon that rolls upright on a line, gravity 9.81 m/s^2.
struct Polygon {
    int sides;
    double radius;   ///< metres, of its corners
    double inertia;  ///< m^2, about its middle, for a mass of 1
    double friction; ///< coefficient

    /// The part of its speed, m/s, that is left after so many seconds, in steps as Bullet's: velocity before place, and
    /// no corner goes below the line. Every corner is known to rounding, and each step is solved to its end: what is
    /// lost here is no matter of contacts. It begins on a side.
    double keeps(double speed, double seconds, double hertz) const;
};

} // namespace raycontact::scenes
