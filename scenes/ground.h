// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/description.h>

namespace raycontact::scenes {

/// Adds the ground of the avalanche: a closed slab about the origin, `depth` metres thick, whose top is z = 0 and which
/// reaches `half_width` metres along x and y; one more shape and one more body, the scene's slab. The region begins on
/// it and ends `top` metres above.
void add_slab(SceneDescription& description, double half_width, double top, double depth = 2);

} // namespace raycontact::scenes
