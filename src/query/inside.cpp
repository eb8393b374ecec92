// SPDX-License-Identifier: Apache-2.0
#include "query/inside.h"

#include "shape/mesh_rays.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace raycontact {

namespace {

/// What a segment from a point has to do with a triangle.
enum class Crossing {
    none,
    out, ///< it leaves through the front
    in,
    unclear, ///< it meets an edge or a corner, or lies in the plane: another segment must be asked
    at_once, ///< the point itself is on the triangle
};

Crossing crossing(const PlacedPoint& from, const PlacedPoint& to, const std::array<PlacedPoint, 3>& t) {
    const int before = orient3d(t[0], t[1], t[2], from), after = orient3d(t[0], t[1], t[2], to);
    if (before == after && before != 0) return Crossing::none;
    bool positive = false, negative = false, on_edge = false;
    for (std::size_t k = 0; k < 3; ++k) {
        const int side = orient3d(from, to, t[k], t[(k + 1) % 3]);
        positive = positive || side > 0;
        negative = negative || side < 0;
        on_edge = on_edge || side == 0;
    }
    if (positive && negative) return Crossing::none;
    if (before == 0 && after != 0) return Crossing::at_once;
    if (on_edge || before == 0 || after == 0) return Crossing::unclear;
    return before > after ? Crossing::out : Crossing::in;
}

/// What all triangles have to do with a segment that ends outside of the mesh's box: a winding number, if it is clear.
struct Winding {
    int number = 0;
    Crossing worst = Crossing::none; ///< or unclear, or at_once

    void add(Crossing crossing) {
        if (crossing == Crossing::out) ++number;
        if (crossing == Crossing::in) --number;
        if (crossing == Crossing::unclear || crossing == Crossing::at_once) worst = crossing;
    }
};

Winding winding_along(const PlacedShape& shape, const PlacedPoint& from, const PlacedPoint& to) {
    const ShapeData& mesh = shape.shape();
    const double slack = from.placing->error + rounding_of(mesh);
    const Vec3 grow{slack, slack, slack};
    const Box box{least(from.rough, to.rough) - grow, most(from.rough, to.rough) + grow};
    const double float_rounding = float_rounding_of(mesh.reach + length(from.rough) + length(to.rough));
    Winding winding;
    shape.each_tree([&](const TriangleTree& tree) {
        visit_blocks(
            tree, [&](const Box& other) { return other.touches(box); },
            [&](const kernels::TriangleBlock& block) {
                const Lanes<float> squares = BlockBoxes(block, float_rounding).squared_distances(box);
                for (std::size_t lane = 0; lane < TRIANGLE_LANES && winding.worst == Crossing::none; ++lane) {
                    const std::uint32_t face = block.triangle[lane];
                    if (face == NONE || squares[lane] > 0 || mesh.is_flat(face)) continue;
                    winding.add(crossing(from, to, shape.triangle(face)));
                }
                return winding.worst == Crossing::none;
            });
    });
    return winding;
}

} // namespace

bool is_inside(const PlacedShape& shape, const PlacedPoint& point) {
    const ShapeData& mesh = shape.shape();
    const Box box = box_of(mesh);
    const Vec3& p = point.rough;
    const double slack = point.placing->error + rounding_of(mesh);
    if (!(box.squared_distance(p) <= 3 * slack * slack)) return false;
    // Straight out through a face of the box, a little askew, so that a segment's box stays slim.
    std::uint32_t state = 1;
    const auto askew = [&] {
        state = state * 1664525u + 1013904223u;
        return 0.01 * (static_cast<double>(state >> 8) / 8388608.0 - 1);
    };
    constexpr int attempts = 64; // as many that all meet an edge: the point is on the surface
    for (int i = 0; i < attempts; ++i) {
        const double rise = box.high.x - p.x + 0.1 * mesh.diagonal;
        const PlacedPoint to = shape.point({p.x + rise, p.y + askew() * rise, p.z + askew() * rise});
        const Winding winding = winding_along(shape, point, to);
        if (winding.worst == Crossing::at_once) return true;
        if (winding.worst == Crossing::none) return winding.number != 0;
    }
    return true;
}

bool is_inside(const ShapeData& shape, const Pose& pose, const Vec3& point) {
    const Vec3 apart = point - pose.translation;
    const auto size = [](const Vec3& v) { return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z); };
    const double sizes = shape.reach + size(shape.centre) + size(apart);
    if (sizes > 1e10) return false; // farther than a mesh can reach
    Placing at({1, 0, 0, 0, 1, 0, 0, 0, 1}, point, pose.translation);
    at.error = 1e-14 * sizes; // some twenty roundings
    const Vec3 rough = rotated(inverse_of(pose.rotation), apart) - shape.centre;
    return is_inside(PlacedShape(shape, pose, pose.translation, 1e-15 * shape.reach), {rough, {}, &at});
}

std::optional<std::uint32_t> vertex_inside(const ShapePair& pair) {
    if (pair.far_apart() || pair.b().shape().header.closed == 0) return std::nullopt;
    for (const std::uint32_t v : pair.a().component_vertices)
        if (is_inside(pair.b(), pair.vertex_of_a(v))) return v;
    return std::nullopt;
}

} // namespace raycontact
