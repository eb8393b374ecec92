// SPDX-License-Identifier: Apache-2.0
#include "mesh/vector.h"
#include "shape/build.h"

namespace raycontact {

std::vector<float> measure_areas(const ShapeData& shape) {
    std::vector<double> sums(shape.points.size());
    for (std::uint32_t t = 0; t < shape.mesh.triangles.size(); ++t) {
        const Vec3 a = shape.corner(t, 0);
        const double area = 0.5 * length(cross(shape.corner(t, 1) - a, shape.corner(t, 2) - a));
        for (const std::uint32_t v : shape.mesh.triangles[t]) sums[v] += area / 3;
    }
    std::vector<float> areas;
    areas.reserve(sums.size());
    for (const double sum : sums) areas.push_back(static_cast<float>(sum));
    return areas;
}

} // namespace raycontact
