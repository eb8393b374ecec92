// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"

#include <raycontact/pose.h>
#include <raycontact/user_memory.h>

#include <vector>

namespace raycontact {

/// Reads `count` poses. Throws InputError naming the place of the first that is none, or what memory is missing.
std::vector<Pose> read_poses(Executor& executor, const UserMemory& memory, std::size_t count, PoseForm form,
                             NumberType type);

} // namespace raycontact
