// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/accelerators.h"

namespace raycontact {

/// A shape's data with its accelerators in place, as the kernels see them. The outside grid and the normal-cone balls
/// are the shape's own.
inline ShapeData accelerated(const Shape& shape) {
    shape.prepare();
    const Accelerators& more = *accelerators_of(shape);
    ShapeData data = shape.data();
    data.header = more.header;
    data.clearances = more.clearances;
    data.set_places();
    return data;
}

} // namespace raycontact
