// SPDX-License-Identifier: Apache-2.0
// Short rays, several at a time, for a CPU. A ray by itself waits for each test before it knows the next; here a stage
// is done for all rays before the next one begins, so that hardly a branch hangs on a test that is not finished.

#define GROUP_VISITS (4 * RAYS_IN_GROUP + NODE_LANES)

typedef struct {
    RayFrame frame;
    float reach;
    float length, tolerance; // metres; the group seeks no farther than `length`
    uint target;
    uint node_first, block_first;
} GroupRay;

// What is still to be tested: nodes, or triangle blocks (absolute), and for which ray of the group.
typedef struct {
    uint ray[GROUP_VISITS], at[GROUP_VISITS];
    uint count;
} Visits;

// The closest hits not farther than each ray's length. Returns a bit for each ray that is to be cast by itself.
DEVICE uint traverse_group(Closest* closest, const GroupRay* rays, uint ray_count, GLOBAL const Node* RESTRICT nodes,
                           GLOBAL const TriangleBlock* RESTRICT blocks) {
    Visits levels[2], leaves;
    uint hit[GROUP_VISITS];
    uint full = 0u, level = 0u;
    leaves.count = 0u;
    levels[0].count = ray_count;
    for (uint r = 0u; r < ray_count; ++r) {
        levels[0].ray[r] = r;
        levels[0].at[r] = rays[r].node_first;
        closest[r] = nothing_hit(rays[r].length, rays[r].tolerance);
    }
    while (levels[level].count != 0u) {
        const Visits* visits = levels + level;
        Visits* below = levels + (1u - level);
        level = 1u - level;
        below->count = 0u;
        for (uint i = 0u; i < visits->count; ++i) {
            const uint r = visits->ray[i];
            hit[i] = hit_children(&rays[r].frame, nodes + visits->at[i], closest[r].limit, rays[r].tolerance);
        }
        for (uint i = 0u; i < visits->count; ++i) {
            const uint r = visits->ray[i], node_first = rays[r].node_first, block_first = rays[r].block_first;
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
        hit[i] = hit_block(closest + r, &rays[r].frame, blocks + leaves.at[i], rays[r].tolerance, true);
    }
    for (uint i = 0u; i < leaves.count; ++i) {
        const uint r = leaves.ray[i];
        hit_lanes(closest + r, &rays[r].frame, blocks + leaves.at[i], hit[i], rays[r].tolerance, true);
    }
    return full;
}
