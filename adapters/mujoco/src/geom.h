// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>

#include <array>
#include <span>

namespace raycontact::mujoco {

using Triple = std::array<double, 3>;

/// A geom of a model, as the plugin of one version of MuJoCo reads it: what these headers say needs neither MuJoCo's
/// nor RayContact's.
struct Geom {
    enum class Kind { height_field, ball, capsule, ellipsoid, cylinder, box, mesh };
    Kind kind = Kind::mesh;
    std::array<double, 4> size{};     ///< MuJoCo's geom_size; of a height field hfield_size
    std::span<const float> vertices;  ///< x y z each; of a height field the heights, row by row, 0 to 1
    std::span<const int> faces;       ///< three vertices each
    int rows = 0, columns = 0;        ///< of a height field
    std::array<double, 9> rotation{}; ///< geom_xmat
    Triple translation{};             ///< geom_xpos
    int number = 0;                   ///< of the geom in its model
    bool is_field = false;            ///< an SDF: prepared as a whole before its first contact, as MuJoCo bakes it
};

/// Forgets all shapes.
RAYCONTACT_API void forget_shapes();

} // namespace raycontact::mujoco
