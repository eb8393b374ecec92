// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include <array>

namespace raycontact::clash {

/// Unit directions along which no mesh is made: the corners of a crooked tetrahedron.
constexpr std::array<Vec3, 4> askew{
    {{0.5257, 0.6113, 0.5915}, {-0.7482, 0.1301, 0.6506}, {0.3137, -0.8819, 0.352}, {-0.091, 0.1405, -0.9859}}};

} // namespace raycontact::clash
