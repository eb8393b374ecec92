// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "arrays.h"

#include <optional>

namespace raycontact::python {

/// Of None the identity, of a rigid float64 matrix its pose; else empty, and the Python half says what is wrong.
std::optional<Pose> pose_of(nb::handle given);

} // namespace raycontact::python
