// SPDX-License-Identifier: Apache-2.0
#include "edges/inside.h"

#include "shape/mesh_rays.h"

namespace raycontact {

namespace {

bool in_box(const ShapeData& mesh, const Vec3& p) {
    for (std::size_t k = 0; k < 3; ++k)
        if (axis(p, k) < double(mesh.header.low[k]) || axis(p, k) > double(mesh.header.high[k])) return false;
    return true;
}

// A cell of the outside grid that holds the point is outside as a whole.
bool known_outside(const Accelerators* mesh, const Vec3& p) {
    if (mesh == nullptr || mesh->header.grid_size[0] == 0) return false;
    const kernels::ShapeHeader& h = mesh->header;
    std::size_t cell[3];
    for (std::size_t k = 0; k < 3; ++k) {
        const double at = (axis(p, k) - double(h.grid_low[k])) * double(h.grid_scale);
        if (!(at >= 0 && at < double(h.grid_size[k]))) return false;
        cell[k] = static_cast<std::size_t>(at);
    }
    const std::size_t bit = (cell[2] * h.grid_size[1] + cell[1]) * h.grid_size[0] + cell[0];
    return (mesh->outside_cells[bit >> 5] >> (bit & 31u) & 1u) != 0;
}

bool is_inside(const SourceMesh& placed, const Vec3& p) {
    const ShapeData& mesh = placed.target;
    if (!in_box(mesh, p) || known_outside(placed.target_accelerators, p)) return false;
    // Any direction serves; this one is related to no axis and no diagonal.
    const MeshHit hit = closest_hit(mesh, {p, {0.5402, 0.3173, 0.7794}, 0, 1e300});
    return hit.face != NONE && hit.from_inside;
}

} // namespace

bool has_part_inside(const SourceMesh& placed) {
    for (const std::uint32_t v : placed.source.component_vertices)
        if (is_inside(placed, placed.vertex(v))) return true;
    return false;
}

std::optional<FeatureContact> contact_of_inside(const SourceMesh& placed, VertexBody source) {
    std::optional<FeatureContact> deepest;
    const ShapeData& target = placed.target;
    for (std::uint32_t v = 0; v < placed.source.points.size(); ++v) {
        if (placed.source.vertex_triangle[v] == Shape::no_triangle) continue;
        const Vec3 p = placed.vertex(v);
        if (!in_box(target, p)) continue;
        const NearestFace nearest = nearest_face(target, p, deepest ? deepest->depth : 0);
        if (deepest && nearest.distance <= deepest->depth) continue;
        if (!is_inside(placed, p)) continue; // of another component
        const Vec3 out = nearest_point(p, target.corner(nearest.face, 0), target.corner(nearest.face, 1),
                                       target.corner(nearest.face, 2))
                         - p;
        const double depth = length(out);
        const Vec3 normal = depth > 1e-3 * placed.hair ? (1 / depth) * out : normal_of(target, nearest.face);
        if (!(depth > 0)) continue;
        deepest = {source, Feature::inside, v, nearest.face, p, normal, depth};
    }
    return deepest;
}

} // namespace raycontact
