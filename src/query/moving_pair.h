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
    /// Radians by unit of time that both turn together, or less: as many as would bend paths as much as theirs are bent
    /// where each sees the other.
    double turning() const { return turning_; }
    /// How far a direction is from the axes about which a frame sees the other body turn, and about which it turns
    /// itself: the lengths of their products with it. Along an axis nothing is bent.
    struct Across {
        double relative, own;
    };
    /// At most how fast something changes along a direction: this much for each of these lengths.
    struct Rate {
        double relative, own;
        double along(const Across& across) const { return across.relative * relative + across.own * own; }
    };
    /// How the velocity of points of `side` changes in the frame of the other at any time from 0 to 1, and how that
    /// does. They are within `radius` of a point of their centred frame.
    struct Bend {
        Rate change, of_change;
    };
    Bend bend(Side side, const Vec3& middle, double radius) const;

    /// Of any direction, in the frame of `side`.
    Across most_across(Side side) const { return {difference_, side == Side::a ? rate_a_ : rate_b_}; }
    /// Of a unit direction that rests in a frame; spin: of the other body there; own: of the frame.
    Across across(const Vec3& way, const Vec3& spin, const Vec3& own) const {
        return {parallel_ ? length(cross(way, spin)) : difference_, length(cross(way, own))};
    }
    /// About which a body turns, in its own frame.
    const Vec3& spin_of(Side side) const { return side == Side::a ? seen_a_.spin : seen_b_.spin; }

    /// The pair at a time.
    struct Moment {
        double time;
        ShapePair pair;
        Twist seen_in_a, seen_in_b;              ///< points of the other shape, in the centred frame of this one
        Vec3 centre_a, centre_b, spin_a, spin_b; ///< about what they turn, how fast; in the centred frame of b

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
    bool parallel_;                                 ///< they turn about parallel axes, or one does not turn
};

} // namespace raycontact
