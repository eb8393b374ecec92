// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/shape.h>

#include <memory>

namespace raycontact {

/// The shape of a ball or capsule along z through the origin, which is sound; its mesh is a picture of it.
std::shared_ptr<const Shape> make_round(const Round& round);

} // namespace raycontact
