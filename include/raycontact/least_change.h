// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>
#include <raycontact/export.h>
#include <raycontact/pose.h>
#include <raycontact/shape.h>

namespace raycontact {

/// A body of a contact and where it moves. World frame; next: where it is expected at the next step.
struct MovingShape {
    const Shape& shape; ///< its mesh
    Pose now;           ///< of the body frame
    Pose next;          ///< likewise
};

/// For solvers that use speculative contacts (docs/internals/speculative.md). What has sunk by a solver's slop and
/// slides over a seam may leave the next body sideways by less than upwards, and would be stopped. Of a contact that
/// touches, no deeper than `margin` metres, the face beside that the motion passes least: the contact with its normal,
/// depth, triangle and points. Others come back as they are, and so do those of pairs that go no farther than the
/// margin. The key stays. a, b: the bodies of the contact. Not for directions `ray` and `weighted`.
RAYCONTACT_API Contact least_change(const Contact& contact, const MovingShape& a, const MovingShape& b, double margin);

} // namespace raycontact
