// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/vector.h>

namespace raycontact {

/// A push at a place of a free uniform rod with round ends: its other end swings. Metres.
class RodPush {
public:
    /// along: from the first end to the second; zero: a ball. at: the place, 0 at the first end, 1 at the second. out:
    /// the push's direction, unit.
    RodPush(const Vec3& along, double radius, double at, const Vec3& out)
        : out_(out), across_(out), lever_(0), at_(at) {
        const double square = length2(along);
        if (!(square > 0)) return;
        across_ = out - (dot(along, out) / square) * along;
        lever_ = square / (square / 12 + 0.4 * radius * radius);
    }
    /// How far a place goes for each metre that the middle goes.
    Vec3 moved(double place) const { return out_ + ((at_ - 0.5) * (place - 0.5) * lever_) * across_; }
    /// How far the middle goes so that the pushed place goes so far along the push.
    double needed(double metres) const { return metres / dot(moved(at_), out_); }

private:
    Vec3 out_, across_; ///< across the rod
    double lever_, at_;
};

} // namespace raycontact
