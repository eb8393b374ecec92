// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

namespace raycontact {

/// How far the rotation may be from an orthonormal matrix (Frobenius norm), for bounds that rely on it being one.
double shear_bound(const Pose& pose);

/// No less than ||(to - from) v|| / |v| for any v: the spectral norm of a difference of rotations is its Frobenius norm
/// divided by sqrt(2), since such a difference has two equal singular values and a third that is 0; `shear` accounts for
/// matrices that are rotations only nearly. 0 where both are the same.
double turn_bound(const Pose& from, const Pose& to, double shear);

/// The outer frame seen from the inner one.
Pose inverse_pose(const Pose& pose);

/// How far any point within `reach` of the frame's origin moved at most between two poses, metres.
double displacement_bound(const Pose& from, const Pose& to, double reach, double shear);

} // namespace raycontact
