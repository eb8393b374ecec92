// SPDX-License-Identifier: Apache-2.0
#include <raycontact/collide.h>
#include <raycontact/scene.h>

#include "broadphase/sweep_and_prune.h"
#include "executor/float_environment.h"
#include "mesh/descent.h"
#include "mesh/predicates.h"
#include "mesh/self_intersection.h"
#include "pairs/directed_pairs.h"
#include "shape/mesh_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>

namespace raycontact {

namespace {

using Corners = std::array<Vec3, 3>;

constexpr Box everywhere{{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};

// How far a point of a triangle's plane is outside of the triangle, roughly; 0 inside.
double off_triangle(const Vec3& p, const Corners& t) {
    const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
    double off = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 along = t[(k + 1) % 3] - t[k];
        off = std::max(off, -dot(cross(along, p - t[k]), normal) / (length(along) * length(normal)));
    }
    return off;
}

// Where two triangles that meet do so, to rounding: where an edge of one passes the other, or, in a common plane, a
// corner of one or the middle of what their boxes share.
Vec3 meeting_point(const Corners& p, const Corners& q) {
    const Box a = box_of(p), b = box_of(q);
    Vec3 best = 0.5 * (most(a.low, b.low) + least(a.high, b.high));
    double least_off = std::numeric_limits<double>::infinity();
    const auto consider = [&](const Corners& edges, const Corners& t) {
        const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 &from = edges[k], &to = edges[(k + 1) % 3];
            const double before = dot(normal, from - t[0]), after = dot(normal, to - t[0]);
            if (before * after > 0) continue;
            const double part = before == after ? 0 : before / (before - after);
            const Vec3 at = from + part * (to - from);
            const double off = off_triangle(at, t);
            if (off >= least_off) continue;
            least_off = off;
            best = at;
        }
    };
    consider(p, q);
    consider(q, p);
    return best;
}

// Descends both trees at once; a's triangles are placed in the centred frame of b.
class SurfaceTest {
public:
    SurfaceTest(const ShapeData& a, const ShapeData& b, const Pose& a_in_b) : a_(a), b_(b), pose_(a_in_b) {}

    /// Nothing if they do not meet; else a point where they do, in b's centred frame.
    std::optional<Vec3> meet() { return meet(0, everywhere, 0) ? std::optional(where_) : std::nullopt; }
    Vec3 placed(const Vec3& p) const { return snapped(transform_point(pose_, p)); }

private:
    // About a box of a's tree, in b's frame.
    Box turned(const Box& own) const { return world_box(own, pose_, 0); }

    // Calls test(child, box) for the children of a node that reach into a box until it returns true; whether it did.
    template <class Place, class Test>
    static bool any_child(const kernels::Node& node, const Box& near, Place&& place, Test&& test) {
        for (std::size_t lane = 0; lane < NODE_LANES; ++lane) {
            if (node.child[lane] == NONE) continue;
            const Box box = place(box_of(node, lane));
            if (box.touches(near) && test(node.child[lane], box)) return true;
        }
        return false;
    }

    // Whether anything below two children meets, a's in a box. Nodes of a are opened first: their boxes must be turned.
    bool meet(std::uint32_t a, const Box& box, std::uint32_t b) {
        const bool b_is_leaf = (b & LEAF) != 0;
        const auto against_b = [&](std::uint32_t child, const Box& own) {
            if (b_is_leaf) return meet(child, own, b);
            return any_child(b_.nodes[b], own, std::identity(),
                             [&](std::uint32_t other, const Box&) { return meet(child, own, other); });
        };
        if ((a & LEAF) != 0) return b_is_leaf ? blocks_meet(a & ~LEAF, b & ~LEAF) : against_b(a, box);
        const Box near = b_is_leaf ? box_of_block(b & ~LEAF) : everywhere;
        return any_child(
            a_.nodes[a], near, [this](const Box& own) { return turned(own); }, against_b);
    }

    Box box_of_block(std::uint32_t block) const {
        Box box{{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
        for (const std::uint32_t t : b_.triangle_blocks[block].triangle)
            if (t != NONE) box.add(box_of(Corners{b_.corner(t, 0), b_.corner(t, 1), b_.corner(t, 2)}));
        return box;
    }

    bool blocks_meet(std::uint32_t a, std::uint32_t b) {
        const Box box = box_of_block(b);
        for (const std::uint32_t s : a_.triangle_blocks[a].triangle) {
            if (s == NONE) continue;
            const Corners p{placed(a_.corner(s, 0)), placed(a_.corner(s, 1)), placed(a_.corner(s, 2))};
            const Box own = box_of(p);
            if (!own.touches(box)) continue;
            for (const std::uint32_t t : b_.triangle_blocks[b].triangle) {
                if (t == NONE) continue;
                const Corners q{snapped(b_.corner(t, 0)), snapped(b_.corner(t, 1)), snapped(b_.corner(t, 2))};
                if (!own.touches(box_of(q)) || !triangles_meet(p, q)) continue;
                where_ = meeting_point(p, q);
                return true;
            }
        }
        return false;
    }

    const ShapeData &a_, &b_;
    Pose pose_;
    Vec3 where_;
};

// 1: the segment leaves through the triangle's front, -1: it enters, 0: it passes by; nothing: it meets an edge or a
// corner, or lies in the plane, so another segment must be asked.
std::optional<int> crossing(const Vec3& from, const Vec3& to, const Vec3& a, const Vec3& b, const Vec3& c) {
    const int before = orient3d(a, b, c, from), after = orient3d(a, b, c, to);
    if (before == after && before != 0) return 0;
    const std::array sides{orient3d(from, to, a, b), orient3d(from, to, b, c), orient3d(from, to, c, a)};
    bool positive = false, negative = false, on_edge = false;
    for (const int side : sides) {
        positive = positive || side > 0;
        negative = negative || side < 0;
        on_edge = on_edge || side == 0;
    }
    if (positive && negative) return 0;
    if (on_edge || before == 0 || after == 0) return std::nullopt;
    return before > after ? 1 : -1;
}

// Along a segment that ends outside of the mesh's box.
std::optional<int> winding_along(const ShapeData& shape, const Vec3& from, const Vec3& to) {
    const Box box{least(from, to), most(from, to)};
    std::optional<int> winding = 0;
    visit_blocks(
        shape, [&](const Box& other) { return other.touches(box); },
        [&](const kernels::TriangleBlock& block) {
            for (const std::uint32_t face : block.triangle) {
                if (face == NONE || !winding) continue;
                const auto sign = crossing(from, to, snapped(shape.corner(face, 0)), snapped(shape.corner(face, 1)),
                                           snapped(shape.corner(face, 2)));
                winding = sign ? std::optional(*winding + *sign) : std::nullopt;
            }
            return winding.has_value();
        });
    return winding;
}

// How often a closed mesh winds around a point: 0 outside of it, 1 inside of one wound outward and on its surface.
// Exact: each crossing of a ray is decided by exact predicates. `point` in the shape's centred frame.
int winding_number(const ShapeData& shape, const Vec3& point) {
    const Vec3 p = snapped(point);
    const Box box = box_of(shape);
    if (!box.touches({p, p})) return 0;
    // Straight out through a face of the box, a little askew, so that a segment's box stays slim.
    std::uint32_t state = 1;
    const auto askew = [&] {
        state = state * 1664525u + 1013904223u;
        return 0.01 * (static_cast<double>(state >> 8) / 8388608.0 - 1);
    };
    constexpr int attempts = 64; // as many that all meet an edge: the point is on the surface
    for (int i = 0; i < attempts; ++i) {
        const double rise = box.high.x - p.x + 0.1 * shape.diagonal;
        const Vec3 to = snapped({p.x + rise, p.y + askew() * rise, p.z + askew() * rise});
        if (const auto winding = winding_along(shape, p, to)) return *winding;
    }
    return 1;
}

// Their surfaces do not meet, so each component lies inside as a whole or not at all. A vertex of one that does.
std::optional<Vec3> vertex_inside(const ShapeData& source, const Pose& source_in_target, const ShapeData& target) {
    if (target.header.closed == 0) return std::nullopt;
    for (const std::uint32_t v : source.component_vertices) {
        const Vec3 p = transform_point(source_in_target, source.point(v));
        if (winding_number(target, p) != 0) return p;
    }
    return std::nullopt;
}

} // namespace

std::optional<Vec3> common_point(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    const FloatEnvironment environment;
    check_pose(pose_a, "pose of the first mesh");
    check_pose(pose_b, "pose of the second mesh");
    const Pose centred_a = centred_pose(a, pose_a), centred_b = centred_pose(b, pose_b);
    const Pose a_in_b = relative_pose(centred_b, centred_a);
    if (const auto point = SurfaceTest(a.data(), b.data(), a_in_b).meet()) return transform_point(centred_b, *point);
    if (const auto point = vertex_inside(a.data(), a_in_b, b.data())) return transform_point(centred_b, *point);
    if (const auto point = vertex_inside(b.data(), relative_pose(centred_a, centred_b), a.data()))
        return transform_point(centred_a, *point);
    return std::nullopt;
}

bool contains(const Shape& shape, const Vec3& point) {
    const FloatEnvironment environment;
    return shape.has_inside() && winding_number(shape.data(), point - shape.centre()) != 0;
}

bool intersects(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    return common_point(a, pose_a, b, pose_b).has_value();
}

std::vector<Contact> collide(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                             const CollideOptions& options) {
    check_pose(pose_a, "pose of the first mesh");
    check_pose(pose_b, "pose of the second mesh");
    Settings settings;
    settings.method = Method::standard; // nothing to keep for a next step
    settings.direction = options.direction;
    settings.features = options.features;
    settings.execution.threads = options.threads;
    settings.execution.devices = "cpu";
    Scene scene(settings);
    const Pair pair{scene.add(a.shared_from_this(), pose_a), scene.add(b.shared_from_this(), pose_b)};
    const auto contacts = scene.find_contacts({&pair, 1});
    return {contacts.begin(), contacts.end()};
}

} // namespace raycontact
