// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

namespace raycontact {

/// What is wrong with a pose, in words, or null when it is finite and rigid to 1e-4. Allocates nothing.
const char* pose_fault(const Pose& pose);

} // namespace raycontact
