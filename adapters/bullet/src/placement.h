// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <LinearMath/btTransform.h>

#include <array>

namespace raycontact::bullet {

/// A symmetric matrix, row-major, by which a body is stretched in its own frame before it is placed.
using Stretch = std::array<double, 9>;
inline constexpr Stretch no_stretch{1, 0, 0, 0, 1, 0, 0, 0, 1};
/// Of one that is not flat.
Stretch inverse(const Stretch& stretch);

/// A transform of Bullet's as RayContact takes it: x_world = pose * (stretch * x_body).
struct Placement {
    btTransform pose;               ///< rigid; the transform itself, to the bit, where that is rigid to 1e-5
    Stretch stretch = no_stretch;   ///< rounded
    Stretch unrounded = no_stretch; ///< for planes, of which no mesh is made
    bool drifted = false;           ///< the transform is not rigid, but to 1e-3, which is dropped
};

/// Beyond 1e-3 what is not rigid is scale: the stretch holds it, in steps of about 1e-3 in each direction, so that a
/// basis that drifts on does not need a new mesh in every step. kept: the stretch that it had; it stays while it is
/// within one step, or the last bits of a basis could change it in every step. Mirrored: the stretch has a negative
/// determinant. Throws InputError where the transform is not finite or flat.
Placement place(const btTransform& transform, const Stretch& kept = no_stretch);

} // namespace raycontact::bullet
