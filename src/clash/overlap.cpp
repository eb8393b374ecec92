// SPDX-License-Identifier: Apache-2.0
#include "clash/overlap.h"

#include "clash/nudged.h"
#include "clash/parting.h"
#include "mesh/measure.h"
#include "query/inside.h"
#include "query/overlap_patches.h"

#include <algorithm>
#include <unordered_set>

namespace raycontact::clash {

namespace {

PlacedBody body_of(const Part& part) {
    PlacedBody body;
    body.shape = part.shape.get();
    body.pose = part.pose;
    body.centred = centred_pose(*part.shape, part.pose);
    return body;
}

/// Whether no point of the first is outside of the second. Of two that cross, be it by rounding alone as faces are
/// flush, the volume decides.
bool lies_in(const Part& a, const Part& b, bool cross) {
    const ShapePair pair(*a.shape, a.pose, *b.shape, b.pose);
    if (pair.b().shape().header.closed == 0) return false;
    const auto is_in = [&](std::uint32_t v) { return is_inside(pair.b(), pair.vertex_of_a(v)); };
    if (!cross) return std::ranges::all_of(pair.a().component_vertices, is_in);
    if (!a.shape->has_inside()) return false;
    for (std::uint32_t v = 0; v < pair.a().points.size(); ++v)
        if (!is_in(v)) return false;
    const double own = volume_of(a.shape->file_vertices(), a.shape->triangles());
    return overlap_volume(*a.shape, a.pose, *b.shape, b.pose) > (1 - noise) * own;
}

void add_to(std::optional<Box>& box, const Vec3& point) {
    if (!box) box = Box{point, point};
    box->add({point, point});
}

bool holds(const std::optional<Box>& box, const Box& other) {
    return box && least(box->low, other.low) == box->low && most(box->high, other.high) == box->high;
}

/// The vertices of the first in the second; those in the box already add nothing.
void add_vertices_inside(std::optional<Box>& box, const Part& a, const Part& b) {
    const ShapePair pair(*a.shape, a.pose, *b.shape, b.pose);
    const ShapeData& shape = a.shape->data();
    const Pose centred = centred_pose(*a.shape, a.pose);
    const Box room = world_box({b.shape->box_min(), b.shape->box_max()}, b.pose, noise * shape.diagonal);
    std::unordered_set<std::uint32_t> asked;
    visit_blocks(
        shape,
        [&](const Box& own) {
            const Box placed = world_box(own, centred, 0);
            return placed.touches(room) && !holds(box, placed);
        },
        [&](const kernels::TriangleBlock& block) {
            for (const std::uint32_t t : block.triangle) {
                if (t == NONE) continue;
                for (const std::uint32_t v : shape.mesh.triangles[t]) {
                    const Vec3 point = transform_point(a.pose, shape.file_vertex(v));
                    if (!room.touches({point, point}) || holds(box, {point, point}) || !asked.insert(v).second)
                        continue;
                    if (is_inside(pair.b(), pair.vertex_of_a(v))) add_to(box, point);
                }
            }
            return true;
        });
}

} // namespace

Overlap overlap_of(const Part& a, const Part& b) {
    const PlacedBody body_a = body_of(a), body_b = body_of(b);
    const PairMeshes meshes(body_a, body_b);
    Loops loops;
    follow_all(meshes, ShapePair(*a.shape, a.pose, *b.shape, b.pose), loops);
    Overlap overlap;
    overlap.crosses = !loops.crossings().empty();
    overlap.inside = lies_in(a, b, overlap.crosses) || lies_in(b, a, overlap.crosses);
    const bool solid = a.shape->has_inside() && b.shape->has_inside();
    if (!overlap.inside && solid && std::ranges::all_of(loops.loops(), &Loop::is_closed))
        overlap.pierces = falls_apart(meshes, loops, 0) || falls_apart(meshes, loops, 1);
    for (const Crossing& c : loops.crossings()) add_to(overlap.box, transform_point(body_b.centred, c.point));
    if (solid) {
        add_vertices_inside(overlap.box, a, b);
        add_vertices_inside(overlap.box, b, a);
    }
    return overlap;
}

} // namespace raycontact::clash
