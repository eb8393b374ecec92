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

/// A block of the first body in the frame of the second, its boxes grown.
struct Placed {
    BlockBounds bounds;
    float corner[9][lanes]; // as in TriangleBlock
    uint block;
};

DEVICE_BATCH void place(const kernels::TriangleBlock& from, const BlockBounds& own, const float* rotation,
                        const float* translation, float grow, Placed& placed) {
    for (int corner = 0; corner < 9; corner += 3) {
        const float *x = from.corner[corner], *y = from.corner[corner + 1], *z = from.corner[corner + 2];
        for (int axis = 0; axis < 3; ++axis) {
            const float *row = rotation + 3 * axis, move = translation[axis];
            float* to = placed.corner[corner + axis];
            FOR_LANES(k, lanes) {
                to[k] = row[0] * x[k] + row[1] * y[k] + row[2] * z[k] + move;
            }
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        const float *row = rotation + 3 * axis, *x = own.plane[0], *y = own.plane[1], *z = own.plane[2];
        const float *p = placed.corner[axis], *q = placed.corner[3 + axis], *r = placed.corner[6 + axis];
        FOR_LANES(k, lanes) {
            const float low = p[k] < q[k] ? p[k] : q[k], high = p[k] < q[k] ? q[k] : p[k];
            placed.bounds.box[axis][k] = (low < r[k] ? low : r[k]) - grow;
            placed.bounds.box[3 + axis][k] = (high > r[k] ? high : r[k]) + grow;
            placed.bounds.plane[axis][k] = row[0] * x[k] + row[1] * y[k] + row[2] * z[k];
        }
    }
    FOR_LANES(k, lanes) {
        placed.bounds.plane[3][k] = placed.bounds.plane[0][k] * placed.corner[0][k]
                                    + placed.bounds.plane[1][k] * placed.corner[1][k]
                                    + placed.bounds.plane[2][k] * placed.corner[2][k];
    }
}

// A bit for each lane whose box meets that one. Those of empty lanes are NaN or inverted.
DEVICE uint boxes_in_box(const float (*bounds)[lanes], const float* box) {
    int in[lanes];
    FOR_LANES(k, lanes) {
        in[k] = -static_cast<int>((bounds[0][k] <= box[3]) & (bounds[3][k] >= box[0]) & (bounds[1][k] <= box[4])
                                  & (bounds[4][k] >= box[1]) & (bounds[2][k] <= box[5]) & (bounds[5][k] >= box[2]));
    }
    return pack_sixteen(in);
}

DEVICE uint longer_than(const float* lengths, float length) {
    int longer[lanes];
    FOR_LANES(k, lanes) {
        longer[k] = -static_cast<int>(lengths[k] > length);
    }
    return pack_sixteen(longer);
}

constexpr uint kept_blocks = 8;

/// Walks both trees at once.
struct Walk {
    TwoTrees& trees;
    Placed* kept;       // blocks placed before, each in the place of its number
    float size[9] = {}; // |rotation|
    uint count = 0;

    // The boxes of a node of the first body's tree, seen from the second, grown.
    void boxes_of(const kernels::Node& node, float (*boxes)[lanes]) const {
        for (int i = 0; i < 3; ++i) {
            const float *r = trees.rotation + 3 * i, *s = size + 3 * i;
            const float move = trees.translation[i], grow = trees.apart;
            FOR_LANES(k, lanes) {
                const float x = 0.5f * (node.bounds[0][k] + node.bounds[3][k]);
                const float y = 0.5f * (node.bounds[1][k] + node.bounds[4][k]);
                const float z = 0.5f * (node.bounds[2][k] + node.bounds[5][k]);
                const float half_x = 0.5f * (node.bounds[3][k] - node.bounds[0][k]);
                const float half_y = 0.5f * (node.bounds[4][k] - node.bounds[1][k]);
                const float half_z = 0.5f * (node.bounds[5][k] - node.bounds[2][k]);
                const float at = r[0] * x + r[1] * y + r[2] * z + move;
                const float by = s[0] * half_x + s[1] * half_y + s[2] * half_z + grow;
                boxes[i][k] = at - by;
                boxes[3 + i][k] = at + by;
            }
        }
    }

    // Empty lanes of a node hold inverted boxes, which meet nothing.
    void both(uint first_node, uint second_node) {
        const kernels::Node &a = trees.first.nodes[first_node], &b = trees.second.nodes[second_node];
        float boxes[6][lanes], box[6];
        boxes_of(a, boxes);
        for (int k = 0; k < lanes; ++k) {
            if (a.child[k] == NONE) continue;
            for (int i = 0; i < 6; ++i) box[i] = boxes[i][k];
            for (uint in = boxes_in_box(b.bounds, box); in != 0; in &= in - 1)
                pair(a.child[k], box, b.child[first_in(in)]);
        }
    }

    void pair(uint first_child, const float* box, uint second_child) {
        const bool first_leaf = (first_child & LEAF) != 0, second_leaf = (second_child & LEAF) != 0;
        if (second_child == NONE) return;
        if (first_leaf && second_leaf) {
            leaves(first_child & ~LEAF, box, second_child & ~LEAF);
        } else if (first_leaf) {
            const kernels::Node& b = trees.second.nodes[second_child];
            for (uint in = boxes_in_box(b.bounds, box); in != 0; in &= in - 1)
                pair(first_child, box, b.child[first_in(in)]);
        } else if (second_leaf) {
            under_first(first_child, second_child & ~LEAF);
        } else {
            both(first_child, second_child);
        }
    }

    // A node of the first body against a block of the second.
    void under_first(uint first_node, uint block) {
        const kernels::Node& a = trees.first.nodes[first_node];
        float boxes[6][lanes], box[6];
        boxes_of(a, boxes);
        for (int k = 0; k < lanes; ++k) {
            if (a.child[k] == NONE) continue;
            for (int i = 0; i < 6; ++i) box[i] = boxes[i][k];
            if (boxes_in_box(trees.second.bounds[block].box, box) == 0) continue;
            if ((a.child[k] & LEAF) != 0)
                leaves(a.child[k] & ~LEAF, box, block);
            else
                under_first(a.child[k], block);
        }
    }

    // first_box: that of the first block, in the frame of the second.
    void leaves(uint first_block, const float* first_box, uint second_block) {
        const BlockBounds& bounds = trees.second.bounds[second_block];
        const uint asked_first = longer_than(trees.first.bounds[first_block].span, trees.span);
        const uint asked_second = longer_than(bounds.span, trees.span);
        if ((asked_first | asked_second) == 0) return;
        uint near_first = boxes_in_box(bounds.box, first_box);
        if (asked_first == 0) near_first &= asked_second;
        if (near_first == 0) return;
        const kernels::TriangleBlock &a = trees.first.blocks[first_block], &b = trees.second.blocks[second_block];
        Placed& first = kept[first_block % kept_blocks];
        if (first.block != first_block) {
            first.block = first_block;
            place(a, trees.first.bounds[first_block], trees.rotation, trees.translation, trees.apart, first);
        }
        float all[6] = {3e38f, 3e38f, 3e38f, -3e38f, -3e38f, -3e38f};
        for (uint in = near_first; in != 0; in &= in - 1) {
            const int k = first_in(in);
            for (int i = 0; i < 3; ++i) {
                all[i] = bounds.box[i][k] < all[i] ? bounds.box[i][k] : all[i];
                all[3 + i] = bounds.box[3 + i][k] > all[3 + i] ? bounds.box[3 + i][k] : all[3 + i];
            }
        }
        for (uint own = boxes_in_box(first.bounds.box, all); own != 0; own &= own - 1) {
            const int k = first_in(own);
            float box[6];
            for (int i = 0; i < 6; ++i) box[i] = first.bounds.box[i][k];
            uint in = boxes_in_box(bounds.box, box);
            if ((asked_first >> k & 1u) == 0) in &= asked_second;
            if (in != 0) in &= ~apart_by_plane(first, k, b, bounds);
            for (; in != 0; in &= in - 1) {
                if (count == trees.room) flush();
                trees.pairs[count++] = {a.triangle[k], b.triangle[first_in(in)]};
            }
        }
    }

    // A bit for each triangle of the second block that lies on one side of the plane of the first's k-th, or the
    // other way round.
    uint apart_by_plane(const Placed& first, int k, const kernels::TriangleBlock& b, const BlockBounds& bounds) const {
        const float apart = trees.apart;
        const float x = first.bounds.plane[0][k], y = first.bounds.plane[1][k], z = first.bounds.plane[2][k];
        const float height = first.bounds.plane[3][k];
        float corner[9];
        for (int i = 0; i < 9; ++i) corner[i] = first.corner[i][k];
        int out[lanes];
        FOR_LANES(j, lanes) {
            const float p = x * b.corner[0][j] + y * b.corner[1][j] + z * b.corner[2][j] - height;
            const float q = x * b.corner[3][j] + y * b.corner[4][j] + z * b.corner[5][j] - height;
            const float r = x * b.corner[6][j] + y * b.corner[7][j] + z * b.corner[8][j] - height;
            const float nx = bounds.plane[0][j], ny = bounds.plane[1][j], nz = bounds.plane[2][j];
            const float by = bounds.plane[3][j];
            const float s = nx * corner[0] + ny * corner[1] + nz * corner[2] - by;
            const float t = nx * corner[3] + ny * corner[4] + nz * corner[5] - by;
            const float u = nx * corner[6] + ny * corner[7] + nz * corner[8] - by;
            const bool above = ((p > apart) & (q > apart) & (r > apart)) | ((s > apart) & (t > apart) & (u > apart));
            const bool below =
                ((p < -apart) & (q < -apart) & (r < -apart)) | ((s < -apart) & (t < -apart) & (u < -apart));
            out[j] = -static_cast<int>(above | below);
        }
        return pack_sixteen(out);
    }

    void flush() {
        trees.flush(trees.list, trees.pairs, count);
        count = 0;
    }
};

void near_triangles(TwoTrees& trees) {
    Placed kept[kept_blocks];
    for (Placed& placed : kept) placed.block = NONE;
    Walk walk{trees, kept};
    for (int i = 0; i < 9; ++i) walk.size[i] = kernels::magnitude_of(trees.rotation[i]);
    walk.both(0, 0);
    walk.flush();
}

} // namespace
} // namespace raycontact::trees::walks::RAYCONTACT_ISA

#define RAYCONTACT_STRING_(x) #x
#define RAYCONTACT_STRING(x) RAYCONTACT_STRING_(x)

namespace raycontact::trees {

extern const Walks RAYCONTACT_ISA;
const Walks RAYCONTACT_ISA = {RAYCONTACT_STRING(RAYCONTACT_ISA), &walks::RAYCONTACT_ISA::closest_hit,
                              &walks::RAYCONTACT_ISA::near_triangles};

} // namespace raycontact::trees
