// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/options.h>

namespace raycontact::scenes {

/// Of the bodies those that come after the planned steps are left out.
struct RainOptions : SceneOptions {
    RainOptions() {
        bodies = 500;
        steps = 3000;
    }
};

/// The paper's second scene (section 5.1, Figure 8): a source that moves on a circle lets go ten bodies a second, of
/// four concave shapes in turn, of 902, 2130, 3456 and 3458 triangles. The paper states neither circle and height nor
/// the shapes and their sizes. Ours: a bunny, a torus, a star and a knot, each 1 m large, from 7 m above the ground,
/// and a circle on which the next body does not meet the last; 9 800 to 10 200 pairs of boxes overlap at the end.
/// Ground as in the avalanche; its body is the first.
SceneDescription rain(const SceneOptions& options);

} // namespace raycontact::scenes
