// SPDX-License-Identifier: Apache-2.0
#include <scenes/centred_shape.h>

#include <raycontact/error.h>
#include <raycontact/mass.h>

#include <algorithm>
#include <cmath>

namespace raycontact::scenes {

CentredShape centred_shape(Mesh mesh, std::optional<double> size, double scale, Nesting nesting) {
    const PreparedMesh prepared = prepare_mesh(mesh, {.nesting = nesting});
    const MeshReport& report = prepared.report;
    const Vec3 &low = report.box_min, &high = report.box_max;
    const double extent = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
    const double factor = size ? *size / extent : scale;
    if (!std::isfinite(factor) || !(factor > 0) || !std::isfinite(factor * extent))
        throw InputError(mesh.name + ": cannot be scaled by " + std::to_string(factor));
    Vec3 centre{(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2};
    if (report.closed && report.volume > 0) centre = mass_of(prepared.vertices, prepared.triangles).centre;
    for (Vec3& v : mesh.vertices) v = {factor * (v.x - centre.x), factor * (v.y - centre.y), factor * (v.z - centre.z)};
    return {Shape::make(prepare_mesh(mesh, {.nesting = nesting})),
            {factor * centre.x, factor * centre.y, factor * centre.z},
            factor * extent};
}

} // namespace raycontact::scenes
