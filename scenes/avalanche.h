// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/options.h>

namespace raycontact::scenes {

/// The paper's first scene (section 5.1): concave meshes, 1 m large, in a cubic grid fall onto the ground and pile up.
/// z is up, gravity 9.81 m/s^2; the ground is a closed slab whose top is z = 0. Its body is the last.
SceneDescription avalanche(const SceneOptions& options);

} // namespace raycontact::scenes
