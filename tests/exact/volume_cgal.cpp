// SPDX-License-Identifier: Apache-2.0
#include "exact/volume_cgal.h"

// CGAL's headers are not written for these warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Surface_mesh.h>
#pragma GCC diagnostic pop

#include <vector>

namespace raycontact::exact {

namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

Surface surface_of(const Shape& shape, const Pose& pose) {
    Surface surface;
    std::vector<Surface::Vertex_index> index;
    for (const Vec3& v : shape.file_vertices()) {
        const Vec3 p = transform_point(pose, v);
        index.push_back(surface.add_vertex({p.x, p.y, p.z}));
    }
    for (const auto& t : shape.triangles()) surface.add_face(index[t[0]], index[t[1]], index[t[2]]);
    return surface;
}

} // namespace

std::optional<double> shared_volume(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    Surface first = surface_of(a, pose_a), second = surface_of(b, pose_b), shared;
    if (!CGAL::Polygon_mesh_processing::corefine_and_compute_intersection(first, second, shared)) return std::nullopt;
    return CGAL::to_double(CGAL::Polygon_mesh_processing::volume(shared));
}

} // namespace raycontact::exact
