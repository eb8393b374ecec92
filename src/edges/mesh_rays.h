// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"
#include "shape/shape_data.h"
#include "shape/tree_walks.h"

#include <limits>

namespace raycontact {

/// The closest face with least < distance <= most; of equal ones the lowest. direction: unit.
MeshHit closest_hit(const ShapeData& mesh, const Vec3& origin, const Vec3& direction, double least, double most);

/// How a point is nearest to a mesh.
struct NearestFace {
    double distance = std::numeric_limits<double>::infinity();
    std::uint32_t face = NONE;
};

/// The nearest face; or, once one is found within `enough`, that one.
NearestFace nearest_face(const ShapeData& mesh, const Vec3& point, double enough);

/// The point of a triangle that is nearest to p.
Vec3 nearest_point(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

} // namespace raycontact
