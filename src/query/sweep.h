// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/measure.h"
#include "query/impacts.h"

#include <optional>
#include <vector>

namespace raycontact {

/// About the file's vertices of a placed shape, which lie a rounding outside of its own box.
Box box_around(const Shape& shape, const Pose& pose);

/// How far along a ray a box begins, in lengths of the direction, not more than that; infinite: it is missed.
double entry_of(const Box& box, const Vec3& origin, const Vec3& direction);

/// A moving mesh among bodies that stay where they are.
class Sweep {
public:
    /// Throws InputError as time_of_impact().
    Sweep(const Shape& shape, const RigidMotion& motion, double distance);

    /// No later than anything in a box is met; infinite: never.
    double earliest(const Box& box) const;
    /// With a body, at time 0.
    std::optional<Impact> at_start(const Shape& body, const Pose& pose) const;
    /// After that, no earlier than `begin` and no later than `latest`.
    std::optional<Impact> on_the_way(const Shape& body, const Pose& pose, double begin, double latest) const;

private:
    /// A part of the motion, in which a box that moves straight holds the mesh.
    struct Piece {
        double begin, length; ///< in time
        Vec3 from, way;       ///< of the middle of the box, metres
        Vec3 half;
    };
    const Shape& shape_;
    Pose start_; ///< as it was given
    RigidMotion motion_;
    double distance_;
    std::vector<Piece> pieces_;
};

} // namespace raycontact
