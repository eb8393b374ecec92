// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geom.h"

#include <raycontact/shape.h>

#include <memory>

namespace raycontact::mujoco {

/// The shape of a geom: found by its content, since models come and go at one address, and kept while it is used from
/// time to time. Safe to call from several threads. Throws InputError for what cannot be a shape.
/// off_centre: set to true where a mesh is new whose origin, MuJoCo's centre of mass, is not its own.
std::shared_ptr<const Shape> shape_of(const Geom& geom, bool& off_centre);

inline Pose pose_of(const Geom& geom) {
    const auto& [x, y, z] = geom.translation;
    return {geom.rotation, {x, y, z}};
}

} // namespace raycontact::mujoco
