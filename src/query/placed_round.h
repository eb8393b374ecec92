// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/shape.h>

#include <raycontact/pose.h>

#include <optional>

namespace raycontact {

/// A ball or capsule in the world: all within its radius of a placed segment.
class PlacedRound {
public:
    PlacedRound(const Round& round, const Pose& pose);

    /// What of the surface is nearest to a point.
    struct Nearest {
        double distance; ///< metres, below 0 inside
        Vec3 point;      ///< world frame
        Vec3 outward;    ///< unit, world frame: the surface's normal there
    };
    Nearest nearest(const Vec3& point) const;

    /// How far along a ray it meets the surface, from outside or from inside. direction: unit.
    std::optional<double> meet(const Vec3& origin, const Vec3& direction) const;

private:
    Vec3 about_;     ///< world frame; what follows is seen from there, along the axes of the world
    Vec3 from_, to_; ///< ends of the segment
    double radius_;
};

} // namespace raycontact
