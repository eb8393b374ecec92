// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include <array>

namespace raycontact {

/// An upper bound of the distance (Frobenius norm) of the rotation from an orthonormal matrix, for bounds that assume
/// one.
double shear_bound(const Pose& pose);

/// An upper bound of ||(to - from) v|| / |v| for any v: the spectral norm of a difference of rotations is its Frobenius
/// norm divided by sqrt(2), since such a difference has two equal singular values and a third that is 0; `shear`
/// accounts for matrices that are rotations only nearly. 0 where both are the same.
double turn_bound(const Pose& from, const Pose& to, double shear);

/// An upper bound of how far any point within `reach` of the frame's origin moved between two poses, metres.
double displacement_bound(const Pose& from, const Pose& to, double reach, double shear);

/// Two bodies relative to each other. `back` is not taken from `pose`: the transpose of a rotation that is one only to
/// 1e-4 is not its inverse, and that is millimetres on a large slab.
struct PairPlace {
    Pose pose;        ///< the first body's frame seen from the second's
    Vec3 back;        ///< the origin of the second seen from the first
    double shear = 0; ///< of the rotation

    /// Bit for bit relative_pose(first, second): the products of a transpose are the same, in the same order.
    Pose pose_of_second() const {
        const auto& r = pose.rotation;
        return {{r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]}, back};
    }
};
PairPlace place_pair(const Pose& first, const Pose& second, double shear);

/// Upper bounds of how far the vertices of the first body, within `reach_first` of its origin, moved in the frame of
/// the second, and those of the second in the frame of the first, metres. Not a number if squares overflow.
std::array<double, 2> displacement_bounds(const PairPlace& from, const PairPlace& to, double reach_first,
                                          double reach_second);

} // namespace raycontact
