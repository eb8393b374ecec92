// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"

namespace raycontact {

/// Boxes (lower x y z, upper x y z) and planes (unit normal, height) of a block's triangles. Empty lanes hold NaN. A
/// needle's plane is all 0: its normal would not be accurate.
struct BlockBounds {
    float box[6][TRIANGLE_LANES];
    float plane[4][TRIANGLE_LANES];
    float span[TRIANGLE_LANES]; ///< the longest edge_span() of the triangle's own sharp edges, 0 without any
};

} // namespace raycontact
