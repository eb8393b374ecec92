// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "arrays.h"

#include <optional>

namespace raycontact::python {

/// Of 4 x 4 numbers, row-major; empty unless they are finite, rigid and the last row is 0 0 0 1.
std::optional<Pose> rigid_pose(const double* matrix);
/// Of None the identity, of a rigid float64 matrix its pose; else empty, and the Python half says what is wrong.
std::optional<Pose> pose_of(nb::handle given);

} // namespace raycontact::python
