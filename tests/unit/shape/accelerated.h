// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/accelerators.h"

namespace raycontact {

/// A shape's data with its accelerators in place, as the kernels see them; but for the outside grid.
inline ShapeData accelerated(const Shape& shape) {
    shape.prepare();
    const Accelerators& more = *shape.accelerators();
    ShapeData data = shape.data();
    data.header = more.header;
    data.clearances = more.clearances;
    for (std::size_t i = 0; i < more.caps.size(); ++i)
        data.triangle_blocks[i / TRIANGLE_LANES].cap[i % TRIANGLE_LANES] = more.caps[i];
    return data;
}

} // namespace raycontact
