// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "query/nearest_feature.h"
#include "shape/shape_data.h"

#include <array>
#include <cstdint>
#include <optional>

namespace raycontact {

struct NearestTriangle {
    std::uint32_t face; ///< index of Shape::triangles()
    NearestFeature feature;
};

/// The triangle that is nearest to a point of the body frame, decided exactly: of several as near the one with the
/// lowest index in the file. Nothing where all are more than `farthest` metres away.
std::optional<NearestTriangle> nearest_triangle(const ShapeData& mesh, const Vec3& sought, double farthest);

/// A point of the world in the body frame, rounded to double; from there on all is decided exactly. inverse: of the
/// pose's rotation.
Vec3 in_body_frame(const Pose& pose, const std::array<double, 9>& inverse, const Vec3& point);

/// What of one triangle is nearest to a point of the body frame.
NearestFeature nearest_feature(const ShapeData& mesh, std::uint32_t face, const Vec3& sought);

} // namespace raycontact
