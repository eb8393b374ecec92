// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/shape.h>

namespace raycontact {

/// A shape with all that speeds up steps, so that counts of work repeat and no thread is at work beside the steps.
template <class AnyMesh>
std::shared_ptr<const Shape> prepared_shape(const AnyMesh& mesh) {
    auto shape = Shape::make(mesh);
    shape->prepare();
    return shape;
}

} // namespace raycontact
