// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "query/shape_pair.h"

#include <raycontact/rigid_motion.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact {

/// How fast a body's points move in a frame: velocity + spin x point.
struct Twist {
    Vec3 velocity, spin;
    Vec3 at(const Vec3& point) const { return velocity + cross(spin, point); }
};

/// After how long a gap may be gone that changes at this rate now, and whose rate falls by no more than `bend` by unit
/// of time, or grows by at least -bend; 0 where there is none, infinite if never.
inline double time_until(double gap, double rate, double bend) {
    if (!(gap > 0)) return 0;
    const double square = rate * rate + 2 * bend * gap;
    if (rate >= 0 ? !(bend > 0) : square < 0) return std::numeric_limits<double>::infinity();
    const double root = std::sqrt(square);
    return rate < 0 ? 2 * gap / (root - rate) : (rate + root) / bend; // the same number, each where it is precise
}

/// Two moving shapes. Either is looked at in the centred frame of the other, which turns with it: what rides together
/// rests there.
class MovingPair {
public:
    /// The motions are sound, their poses rigid.
    MovingPair(const Shape& a, const RigidMotion& motion_a, const Shape& b, const RigidMotion& motion_b);

    const RigidMotion& motion(Side side) const { return side == Side::a ? motion_a_ : motion_b_; }
    /// Radians by unit of time that both turn at most, together.
    double turning() const { return turning_; }
    /// At most how fast the velocity of points of `side` changes in the other's frame, at any time from 0 to 1, and how
    /// fast that does. They are within `radius` of a point of their centred frame.
    struct Bend {
        double change, of_change;
    };
    Bend bend(Side side, const Vec3& middle, double radius) const;

    /// The pair at a time.
    struct Moment {
        double time;
        ShapePair pair;
        Twist seen_in_a, seen_in_b; ///< points of the other shape, in the centred frame of this one
        /// In the centred frame of b: about what they turn, how fast, and how fast a's centre passes that of b.
        Vec3 centre_a, centre_b, spin_a, spin_b, passing;

        const Twist& seen_in(Side side) const { return side == Side::a ? seen_in_a : seen_in_b; }
        /// How the velocity of a point of `side`, given in the centred frame of b, changes in the frame of the other.
        Vec3 change(Side side, const Vec3& point) const;
    };
    Moment at(double time) const;

private:
    /// Of one body, as the other one sees it.
    struct Seen {
        Vec3 centre; ///< about which it turns, in its own centred frame
        Vec3 spin;   ///< in its own frame
        Bend drift;  ///< what the frame of the other adds for any point
    };
    const Shape &a_, &b_;
    RigidMotion motion_a_, motion_b_;
    Seen seen_a_, seen_b_;
    double rate_a_, rate_b_, difference_, turning_; ///< radians by unit of time
};

} // namespace raycontact
