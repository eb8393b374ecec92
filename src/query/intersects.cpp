// SPDX-License-Identifier: Apache-2.0
#include <raycontact/collide.h>

#include "executor/float_environment.h"
#include "mesh/predicates.h"
#include "mesh/self_intersection.h"
#include "pairs/directed_pairs.h"
#include "query/winding.h"
#include "shape/shape_data.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

namespace raycontact {

namespace {

using Corners = std::array<Vec3, 3>;

// Far more than the rounding of a box that is turned, in parts of its farthest coordinate.
constexpr double rounding = 1e-12;

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
    SurfaceTest(const ShapeData& a, const ShapeData& b, const Pose& a_in_b) : a_(a), b_(b), pose_(a_in_b) {
        for (std::size_t k = 0; k < 9; ++k) size_[k] = std::fabs(pose_.rotation[k]);
    }

    /// Nothing if they do not meet; else a point where they do, in b's centred frame.
    std::optional<Vec3> meet() { return meet(0, 0) ? std::optional(where_) : std::nullopt; }
    Vec3 placed(const Vec3& p) const { return snapped(transform_point(pose_, p)); }

private:
    // Box about a box of a's tree, in b's frame.
    Box turned(const kernels::Node& node, int lane) const {
        const Vec3 low{node.bounds[0][lane], node.bounds[1][lane], node.bounds[2][lane]};
        const Vec3 high{node.bounds[3][lane], node.bounds[4][lane], node.bounds[5][lane]};
        const Vec3 centre = transform_point(pose_, 0.5 * (low + high)), half = 0.5 * (high - low);
        Vec3 reach{(size_[0] * half.x + size_[1] * half.y) + size_[2] * half.z,
                   (size_[3] * half.x + size_[4] * half.y) + size_[5] * half.z,
                   (size_[6] * half.x + size_[7] * half.y) + size_[8] * half.z};
        const double more =
            rounding * (std::fabs(centre.x) + std::fabs(centre.y) + std::fabs(centre.z) + reach.x + reach.y + reach.z);
        reach = reach + Vec3{more, more, more};
        return {centre - reach, centre + reach};
    }

    static std::uint32_t touching(const Box& box, const kernels::Node& node) {
        std::uint32_t lanes = 0;
        for (int lane = 0; lane < NODE_LANES; ++lane) {
            const bool touches = (box.low.x <= node.bounds[3][lane]) & (box.high.x >= node.bounds[0][lane])
                                 & (box.low.y <= node.bounds[4][lane]) & (box.high.y >= node.bounds[1][lane])
                                 & (box.low.z <= node.bounds[5][lane]) & (box.high.z >= node.bounds[2][lane]);
            lanes |= std::uint32_t{touches} << lane;
        }
        return lanes;
    }

    bool meet(std::uint32_t a, std::uint32_t b) {
        const kernels::Node& node = a_.nodes[a];
        for (int lane = 0; lane < NODE_LANES; ++lane) {
            const std::uint32_t child = node.child[lane];
            if (child == NONE) continue;
            const bool met = (child & LEAF) != 0 ? block_meets(child & ~LEAF, turned(node, lane), b)
                                                 : node_meets(child, turned(node, lane), b);
            if (met) return true;
        }
        return false;
    }

    // A node of a against the children of a node of b.
    bool node_meets(std::uint32_t a, const Box& box, std::uint32_t b) {
        const kernels::Node& node = b_.nodes[b];
        for (std::uint32_t lanes = touching(box, node); lanes != 0; lanes &= lanes - 1) {
            const std::uint32_t child = node.child[std::countr_zero(lanes)];
            if ((child & LEAF) == 0 ? meet(a, child) : meet_leaf(a, child & ~LEAF)) return true;
        }
        return false;
    }

    // All below a node of a against one block of b.
    bool meet_leaf(std::uint32_t a, std::uint32_t block) {
        const Box box = box_of_block(block);
        const kernels::Node& node = a_.nodes[a];
        for (int lane = 0; lane < NODE_LANES; ++lane) {
            const std::uint32_t child = node.child[lane];
            if (child == NONE || !turned(node, lane).touches(box)) continue;
            if ((child & LEAF) != 0 ? blocks_meet(child & ~LEAF, block) : meet_leaf(child, block)) return true;
        }
        return false;
    }

    // A block of a against all below a node of b.
    bool block_meets(std::uint32_t block, const Box& box, std::uint32_t b) {
        const kernels::Node& node = b_.nodes[b];
        for (std::uint32_t lanes = touching(box, node); lanes != 0; lanes &= lanes - 1) {
            const std::uint32_t child = node.child[std::countr_zero(lanes)];
            if ((child & LEAF) != 0 ? blocks_meet(block, child & ~LEAF) : block_meets(block, box, child)) return true;
        }
        return false;
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
    std::array<double, 9> size_{}; ///< of the rotation's entries
    Vec3 where_;
};

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

} // namespace raycontact
