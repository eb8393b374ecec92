// SPDX-License-Identifier: Apache-2.0
// Short rays, several at a time, for a CPU. A ray by itself waits for each test before it knows the next; here a stage
// is done for all rays before the next one begins, so that hardly a branch hangs on a test that is not finished.
// NOLINTBEGIN(modernize-use-using): this text is C as well

#define GROUP_VISITS (4 * RAYS_IN_GROUP + NODE_LANES)

// A ray in each lane; of its frame, what RayFrame holds.
typedef struct {
    float position[3][RAYS_IN_GROUP], direction[3][RAYS_IN_GROUP]; // target frame
    float origin[3][RAYS_IN_GROUP], shear[3][RAYS_IN_GROUP], inverse[3][RAYS_IN_GROUP];
    uint axis[3][RAYS_IN_GROUP];
    float reach[RAYS_IN_GROUP];
    float length[RAYS_IN_GROUP], tolerance[RAYS_IN_GROUP]; // metres; the group seeks no farther than `length`
    uint target[RAYS_IN_GROUP];
    uint node_first[RAYS_IN_GROUP], block_first[RAYS_IN_GROUP];
} Group;

// Lanes without a ray are framed with the others.
DEVICE void clear_group(Group* group) {
    for (int i = 0; i < 3; ++i) FOR_LANES(r, RAYS_IN_GROUP) group->position[i][r] = group->direction[i][r] = 0.0f;
}

DEVICE void set_ray(Group* group, uint r, const float* position, const float* direction, float reach, float probe,
                    uint target, GLOBAL const ShapeHeader* RESTRICT shape) {
    for (int i = 0; i < 3; ++i) {
        group->position[i][r] = position[i];
        group->direction[i][r] = direction[i];
    }
    group->reach[r] = reach;
    group->length[r] = probe < reach ? probe : reach;
    group->tolerance[r] = shape->tolerance;
    group->target[r] = target;
    group->node_first[r] = shape->node_first;
    group->block_first[r] = shape->triangle_block_first;
}

// frame_ray() for every lane. mirrored: of the ray against the given direction, see opposite_frame().
DEVICE void frame_group(Group* group, const bool mirrored) {
    const float sign = mirrored ? -1.0f : 1.0f;
    FOR_LANES(r, RAYS_IN_GROUP) {
        const float px = group->position[0][r], py = group->position[1][r], pz = group->position[2][r];
        const float dx = sign * group->direction[0][r], dy = sign * group->direction[1][r];
        const float dz = sign * group->direction[2][r];
        const float ax = magnitude_of(dx), ay = magnitude_of(dy), az = magnitude_of(dz);
        const float larger = ax > ay ? ax : ay;
        const uint z = larger > az ? (uint)(ax <= ay) : 2u;
        const uint next = z == 2u ? 0u : z + 1u, last = 3u - z - next;
        const float far = z == 0u ? dx : z == 1u ? dy : dz;
        const uint down = (uint)(far < 0.0f) ^ (uint)mirrored;
        const uint x = down != 0u ? last : next, y = down != 0u ? next : last;
        const float ix = safe_inverse(dx), iy = safe_inverse(dy), iz = safe_inverse(dz);
        const float far_inverse = z == 0u ? ix : z == 1u ? iy : iz;
        group->axis[0][r] = x;
        group->axis[1][r] = y;
        group->axis[2][r] = z;
        group->origin[0][r] = x == 0u ? px : x == 1u ? py : pz;
        group->origin[1][r] = y == 0u ? px : y == 1u ? py : pz;
        group->origin[2][r] = z == 0u ? px : z == 1u ? py : pz;
        group->shear[0][r] = (x == 0u ? dx : x == 1u ? dy : dz) * far_inverse;
        group->shear[1][r] = (y == 0u ? dx : y == 1u ? dy : dz) * far_inverse;
        group->shear[2][r] = far_inverse;
        group->inverse[0][r] = ix;
        group->inverse[1][r] = iy;
        group->inverse[2][r] = iz;
    }
}

DEVICE RayFrame frame_of(const Group* group, uint r) {
    RayFrame frame;
    for (int i = 0; i < 3; ++i) {
        frame.origin[i] = group->origin[i][r];
        frame.shear[i] = group->shear[i][r];
        frame.axis[i] = group->axis[i][r];
        frame.raw_origin[i] = group->position[i][r];
        frame.inverse[i] = group->inverse[i][r];
        const uint down = (uint)(frame.inverse[i] < 0.0f);
        frame.near_plane[i] = (uint)i + 3u * down;
        frame.far_plane[i] = (uint)i + 3u * (1u - down);
    }
    return frame;
}

// What is still to be tested: nodes, or triangle blocks (absolute), and for which ray of the group.
typedef struct {
    uint ray[GROUP_VISITS], at[GROUP_VISITS];
    uint count;
} Visits;

// The closest hits of some rays of a group, not farther than each ray's length. Returns a bit for each ray that is to
// be cast by itself.
DEVICE uint traverse_group(Closest* closest, const Group* group, const uint* which, uint ray_count,
                           GLOBAL const Node* RESTRICT nodes, GLOBAL const TriangleBlock* RESTRICT blocks) {
    Visits levels[2], leaves;
    uint hit[GROUP_VISITS];
    uint full = 0u, level = 0u;
    leaves.count = 0u;
    levels[0].count = ray_count;
    for (uint i = 0u; i < ray_count; ++i) {
        const uint r = which[i];
        levels[0].ray[i] = r;
        levels[0].at[i] = group->node_first[r];
        closest[r] = nothing_hit(group->length[r], group->tolerance[r]);
    }
    while (levels[level].count != 0u) {
        const Visits* visits = levels + level;
        Visits* below = levels + (1u - level);
        level = 1u - level;
        below->count = 0u;
        for (uint i = 0u; i < visits->count; ++i) {
            const uint r = visits->ray[i];
            const RayFrame frame = frame_of(group, r);
            hit[i] = hit_children(&frame, nodes + visits->at[i], closest[r].limit, group->tolerance[r]);
        }
        for (uint i = 0u; i < visits->count; ++i) {
            const uint r = visits->ray[i], node_first = group->node_first[r], block_first = group->block_first[r];
            GLOBAL const uint* RESTRICT children = nodes[visits->at[i]].child;
            if (below->count + NODE_LANES > GROUP_VISITS || leaves.count + NODE_LANES > GROUP_VISITS) {
                full |= 1u << r;
                continue;
            }
            // Written to both, and kept in one: which it is, is hard to guess.
            for (uint left = hit[i]; left != 0u; left &= left - 1u) {
                const uint child = children[lowest_bit(left)], leaf = (uint)((child & LEAF) != 0u);
                leaves.ray[leaves.count] = r;
                leaves.at[leaves.count] = block_first + (child & ~LEAF);
                leaves.count += leaf;
                below->ray[below->count] = r;
                below->at[below->count] = node_first + child;
                below->count += 1u - leaf;
            }
        }
    }
    for (uint i = 0u; i < leaves.count; ++i) {
        const uint r = leaves.ray[i];
        const RayFrame frame = frame_of(group, r);
        hit[i] = hit_block(closest + r, &frame, blocks + leaves.at[i], group->tolerance[r], true);
    }
    for (uint i = 0u; i < leaves.count; ++i) {
        const uint r = leaves.ray[i];
        const RayFrame frame = frame_of(group, r);
        hit_lanes(closest + r, &frame, blocks + leaves.at[i], hit[i], group->tolerance[r], true);
    }
    return full;
}
// NOLINTEND(modernize-use-using)
