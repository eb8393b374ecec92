// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"

#include <span>
#include <vector>

namespace raycontact {

/// A way that parts two convex hulls.
struct HullExit {
    Vec3 way; ///< of the second, unit
    double metres;
};

/// How far the hull of one point set has to go along a direction until it is beyond that of another: the reach of all
/// differences of their points, a convex function that is positively homogeneous (a support function; Rockafellar
/// 1970).
class HullExits {
public:
    /// The second has to go. radius: of both together, if they are round, metres.
    HullExits(std::vector<Vec3> first, std::vector<Vec3> second, double radius)
        : a_(std::move(first)), b_(std::move(second)), radius_(radius) {}

    /// way: unit. Negative where they are parted already.
    double along(const Vec3& way) const { return dot(farthest(way), way); }
    /// The shortest way out, too long by no more than a share of it, and of `size`.
    HullExit shortest(double share, double size) const;

private:
    /// Of the differences of a point of a and one of b that which is farthest along a direction, which is unit.
    Vec3 farthest(const Vec3& way) const;
    std::vector<Vec3> a_, b_;
    double radius_;
};

} // namespace raycontact
