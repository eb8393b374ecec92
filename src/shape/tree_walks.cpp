// SPDX-License-Identifier: Apache-2.0
// Compiled once for each instruction set, as the kernels are. Nothing here calls an inline function of another header:
// the linker keeps one copy of those, and it may be one that this processor cannot run.
#include "shape/tree_walks.h"

#include <cmath>

namespace raycontact::trees::walks::RAYCONTACT_ISA {
using kernels::uint;
#include "device/cpu/instruction_set.h"

namespace {

constexpr int lanes = 16;
static_assert(lanes == NODE_LANES);
static_assert(lanes == TRIANGLE_LANES);
// Each level of a tree leaves at most fifteen children waiting.
constexpr int most_waiting = NODE_LEVELS * NODE_LANES + 1;
constexpr double never = std::numeric_limits<double>::infinity();

DEVICE int first_in(uint bits) {
    return static_cast<int>(kernels::lowest_bit(bits));
}

// A bit for each child whose box the ray meets within `most`, and where it enters the boxes. In float: the boxes are
// grown by far more than its rounding.
DEVICE uint children_on_ray(const kernels::Node& node, const float* o, const float* inverse, float most, float* enter) {
    float leave[lanes];
    FOR_LANES(k, lanes) {
        enter[k] = 0;
        leave[k] = most;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const float at = o[axis], by = inverse[axis];
        FOR_LANES(k, lanes) {
            const float t0 = (node.bounds[axis][k] - at) * by, t1 = (node.bounds[3 + axis][k] - at) * by;
            const float first = t0 < t1 ? t0 : t1, last = t0 < t1 ? t1 : t0;
            enter[k] = first > enter[k] ? first : enter[k];
            leave[k] = last < leave[k] ? last : leave[k];
        }
    }
    int in[lanes];
    FOR_LANES(k, lanes) {
        in[k] = -static_cast<int>((enter[k] <= leave[k]) & (node.child[k] != NONE));
    }
    return pack_sixteen(in);
}

// A bit for each triangle that the ray's line passes within the rounding of floats: all that meet() can accept, and
// some more. error: with S, the farthest corner's distance from the mesh's centre and the origin's added, a volume in
// float is wrong by less than 2e-6 S^2; twice that serves.
DEVICE uint triangles_on_line(const kernels::TriangleBlock& block, const float* origin, const float* direction,
                              float error) {
    const float ox = origin[0], oy = origin[1], oz = origin[2];
    const float dx = direction[0], dy = direction[1], dz = direction[2];
    int on[lanes];
    FOR_LANES(k, lanes) {
        const float px = block.corner[0][k] - ox, py = block.corner[1][k] - oy, pz = block.corner[2][k] - oz;
        const float qx = block.corner[3][k] - ox, qy = block.corner[4][k] - oy, qz = block.corner[5][k] - oz;
        const float rx = block.corner[6][k] - ox, ry = block.corner[7][k] - oy, rz = block.corner[8][k] - oz;
        const float u = (qy * rz - qz * ry) * dx + (qz * rx - qx * rz) * dy + (qx * ry - qy * rx) * dz;
        const float v = (ry * pz - rz * py) * dx + (rz * px - rx * pz) * dy + (rx * py - ry * px) * dz;
        const float w = (py * qz - pz * qy) * dx + (pz * qx - px * qz) * dy + (px * qy - py * qx) * dz;
        const int from_inside = (u >= -error) & (v >= -error) & (w >= -error);
        const int from_outside = (u <= error) & (v <= error) & (w <= error);
        on[k] = -(from_inside | from_outside);
    }
    return pack_sixteen(on);
}

// Where the ray meets a triangle; otherwise `never`. Edges belong to the triangle.
DEVICE double meet(const kernels::TriangleBlock& block, int k, const Ray& ray, bool& from_inside) {
    const double ox = ray.origin[0], oy = ray.origin[1], oz = ray.origin[2];
    const double dx = ray.direction[0], dy = ray.direction[1], dz = ray.direction[2];
    const double px = block.corner[0][k] - ox, py = block.corner[1][k] - oy, pz = block.corner[2][k] - oz;
    const double qx = block.corner[3][k] - ox, qy = block.corner[4][k] - oy, qz = block.corner[5][k] - oz;
    const double rx = block.corner[6][k] - ox, ry = block.corner[7][k] - oy, rz = block.corner[8][k] - oz;
    const double u = (qy * rz - qz * ry) * dx + (qz * rx - qx * rz) * dy + (qx * ry - qy * rx) * dz;
    const double v = (ry * pz - rz * py) * dx + (rz * px - rx * pz) * dy + (rx * py - ry * px) * dz;
    const double w = (py * qz - pz * qy) * dx + (pz * qx - px * qz) * dy + (px * qy - py * qx) * dz;
    from_inside = u >= 0 && v >= 0 && w >= 0;
    if (!from_inside && !(u <= 0 && v <= 0 && w <= 0)) return never;
    const double volume = u + v + w;
    if (volume == 0) return never;
    const double at =
        (u * (px * dx + py * dy + pz * dz) + v * (qx * dx + qy * dy + qz * dz) + w * (rx * dx + ry * dy + rz * dz))
        / volume;
    return at > ray.least && at <= ray.most ? at : never;
}

DEVICE bool is_skipped(const Ray& ray, uint face) {
    for (uint i = 0; i < ray.skipped_count; ++i)
        if (ray.skipped[i] == face) return true;
    return false;
}

MeshHit closest_hit(const Tree& tree, const Ray& ray) {
    float from[3], along[3], inverse[3];
    double apart = ray.reach;
    for (int axis = 0; axis < 3; ++axis) {
        const double d = ray.direction[axis];
        from[axis] = static_cast<float>(ray.origin[axis]);
        along[axis] = static_cast<float>(d);
        apart += std::fabs(ray.origin[axis]);
        inverse[axis] = static_cast<float>(1 / (std::fabs(d) > 1e-20 ? d : 1e-20));
    }
    const float error = static_cast<float>(4e-6 * apart * apart);
    MeshHit hit{never, NONE, false};
    // What waits, the nearest last among the children of one node.
    uint waiting[most_waiting];
    float enters[most_waiting];
    int count = 0;
    waiting[count] = 0;
    enters[count++] = 0;
    while (count > 0) {
        const double limit = (ray.most < hit.distance ? ray.most : hit.distance) + ray.tolerance;
        const float reach = limit < 3e38 ? static_cast<float>(1.000001 * limit) : 3e38f;
        const uint next = waiting[--count];
        if (enters[count] > reach) continue;
        if ((next & LEAF) != 0) {
            const kernels::TriangleBlock& block = tree.blocks[next & ~LEAF];
            for (uint on = triangles_on_line(block, from, along, error); on != 0; on &= on - 1) {
                const int k = first_in(on);
                bool from_inside;
                const double at = meet(block, k, ray, from_inside);
                if ((ray.from_inside && !from_inside) || is_skipped(ray, block.triangle[k])) continue;
                if (at == never || at > hit.distance || (at == hit.distance && block.triangle[k] >= hit.face)) continue;
                hit = {at, block.triangle[k], from_inside};
            }
            continue;
        }
        const kernels::Node& node = tree.nodes[next];
        float enter[lanes];
        const int first = count;
        for (uint found = children_on_ray(node, from, inverse, reach, enter); found != 0; found &= found - 1) {
            const int k = first_in(found);
            int at = count++;
            for (; at > first && enters[at - 1] < enter[k]; --at) {
                enters[at] = enters[at - 1];
                waiting[at] = waiting[at - 1];
            }
            enters[at] = enter[k];
            waiting[at] = node.child[k];
        }
    }
    return hit;
}

} // namespace
} // namespace raycontact::trees::walks::RAYCONTACT_ISA

#define RAYCONTACT_STRING_(x) #x
#define RAYCONTACT_STRING(x) RAYCONTACT_STRING_(x)

namespace raycontact::trees {

extern const Walks RAYCONTACT_ISA;
const Walks RAYCONTACT_ISA = {RAYCONTACT_STRING(RAYCONTACT_ISA), &walks::RAYCONTACT_ISA::closest_hit};

} // namespace raycontact::trees
