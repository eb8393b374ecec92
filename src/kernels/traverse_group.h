// SPDX-License-Identifier: Apache-2.0
// Casts rays of finite length, several at a time, if RAYS_IN_GROUP is more than 1: on a CPU. A single ray must finish
// each test before it knows the next one. Here each stage is done for all rays before the next stage begins, so that
// hardly any branch depends on an unfinished test. The rays of a pair begin side by side, and short ones end there: the
// leaves that overlap the box around them are found once, and each ray is tested only against these.

#define GROUP_VISITS (8 * RAYS_IN_GROUP) // a single ray has two or three leaves

// The rays of a group, by pair: rays of one pair are neighbours in the group, and short ones have a small box.
STRUCT(Runs) {
    float box[RAYS_IN_GROUP][6]; // lower x y z, upper x y z
    uint rays[RAYS_IN_GROUP];    // a bit each
    READS(Node) tree[RAYS_IN_GROUP];
    READS(TriangleBlock) blocks[RAYS_IN_GROUP];
    uint count;
};

// Nodes to be visited, and for which run.
STRUCT(Visits) {
    uint who[GROUP_VISITS];
    READS(Node) at[GROUP_VISITS];
    uint count;
};

// Leaves that overlap a run's box: lanes of nodes.
STRUCT(NearLeaves) {
    uint run[GROUP_VISITS], lane[GROUP_VISITS];
    READS(Node) node[GROUP_VISITS];
    READS(TriangleBlock) block[GROUP_VISITS];
    uint meets[GROUP_VISITS]; // rays of the run, a bit each
    uint count;
};

// The box of a run contains its rays up to their lengths, and as far beyond either end as they are tested.
DEVICE void find_runs(Runs* runs, const RayGroup* group, READS(ulong) memory) {
    float low[3][RAYS_IN_GROUP], high[3][RAYS_IN_GROUP];
    for (int i = 0; i < 3; ++i) {
        FOR_LANES(r, RAYS_IN_GROUP) {
            const float beyond = 3.0f * group->tolerance[r];
            const float start = group->position[i][r], end = start + group->length[r] * group->direction[i][r];
            low[i][r] = (start < end ? start : end) - beyond;
            high[i][r] = (start < end ? end : start) + beyond;
        }
    }
    uint run = NONE;
    for (uint r = 0u; r < group->count; ++r) {
        const bool begins = r == 0u || group->pair[r] != group->pair[r - 1u];
        if (begins) {
            ++run;
            runs->rays[run] = 0u;
            runs->tree[run] = AT(memory, Node, group->shape[r]->nodes);
            runs->blocks[run] = AT(memory, TriangleBlock, group->shape[r]->triangle_blocks);
        }
        float* box = runs->box[run];
        for (int i = 0; i < 3; ++i) {
            const float lower = begins ? UNBOUNDED : box[i], upper = begins ? -UNBOUNDED : box[3 + i];
            box[i] = low[i][r] < lower ? low[i][r] : lower;
            box[3 + i] = high[i][r] > upper ? high[i][r] : upper;
        }
        runs->rays[run] |= 1u << r;
    }
    runs->count = run + 1u;
}

// Masks of sixteen bits, four at a time: the end of a loop over the bits of a single one is hard to predict.
DEVICE ulong four_sixteens(const uint* masks, uint first, uint count) {
    ulong bits = 0u;
    for (uint i = 0u; i < 4u; ++i) bits |= (ulong)(first + i < count ? masks[first + i] : 0u) << (16u * i);
    return bits;
}

// Traverses the trees, all runs a level at a time. Returns a bit for each run whose leaves are not all found.
DEVICE uint find_near_leaves(NearLeaves* leaves, const Runs* runs) {
    Visits levels[2];
    uint near[GROUP_VISITS];
    uint full = 0u, level = 0u;
    leaves->count = 0u;
    levels[0].count = runs->count;
    for (uint i = 0u; i < runs->count; ++i) {
        levels[0].who[i] = i;
        levels[0].at[i] = runs->tree[i];
    }
    while (levels[level].count != 0u) {
        const Visits* visits = levels + level;
        Visits* below = levels + (1u - level);
        level = 1u - level;
        below->count = 0u;
        for (uint i = 0u; i < visits->count; ++i)
            near[i] = ((full >> visits->who[i]) & 1u) != 0u
                          ? 0u // it would take the room of others
                          : lanes_in(runs->box[visits->who[i]], visits->at[i]->bounds);
        for (uint i = 0u; i < visits->count; i += 4u) {
            ulong left = four_sixteens(near, i, visits->count);
            const uint most = bit_count_of_long(left);
            if (below->count + most > GROUP_VISITS || leaves->count + most > GROUP_VISITS) {
                for (uint j = i; j < i + 4u && j < visits->count; ++j)
                    full |= near[j] != 0u ? 1u << visits->who[j] : 0u;
                continue;
            }
            // Written to both lists and counted in one: a branch would be hard to predict.
            for (; left != 0u; left &= left - 1u) {
                const uint bit = lowest_bit_of_long(left), j = i + bit / 16u, lane = bit % 16u;
                const uint run = visits->who[j];
                READS(Node) node = visits->at[j];
                const uint child = node->child[lane], leaf = (uint)((child & LEAF) != 0u);
                leaves->run[leaves->count] = run;
                leaves->node[leaves->count] = node;
                leaves->lane[leaves->count] = lane;
                leaves->block[leaves->count] = runs->blocks[run] + (child & ~LEAF);
                leaves->count += leaf;
                below->who[below->count] = run;
                below->at[below->count] = runs->tree[run] + (child & (leaf - 1u)); // of a leaf it is overwritten
                below->count += 1u - leaf;
            }
        }
    }
    return full;
}

// A bit for each ray of a group that meets a node's lane: hit_children() of one box and all rays. Only for lanes that
// lanes_in() found: an empty lane's inverted box would count as a valid one here.
DEVICE uint rays_that_meet(const RayGroup* group, READS(Node) node, uint lane) {
    const float low_x = node->bounds[0][lane], low_y = node->bounds[1][lane], low_z = node->bounds[2][lane];
    const float high_x = node->bounds[3][lane], high_y = node->bounds[4][lane], high_z = node->bounds[5][lane];
    int meets[NODE_LANES] = {0}; // lanes without a ray
    FOR_LANES(r, RAYS_IN_GROUP) {
        const float px = group->position[0][r], py = group->position[1][r], pz = group->position[2][r];
        const float ix = group->inverse[0][r], iy = group->inverse[1][r], iz = group->inverse[2][r];
        const float ax = (low_x - px) * ix, ay = (low_y - py) * iy, az = (low_z - pz) * iz;
        const float bx = (high_x - px) * ix, by = (high_y - py) * iy, bz = (high_z - pz) * iz;
        const float nx = ax < bx ? ax : bx, ny = ay < by ? ay : by, nz = az < bz ? az : bz;
        const float fx = ax < bx ? bx : ax, fy = ay < by ? by : ay, fz = az < bz ? bz : az;
        const float tolerance = group->tolerance[r];
        meets[r] = -(int)meets_box(nx, ny, nz, fx, fy, fz, group->length[r] + tolerance, tolerance);
    }
    return pack_sixteen(meets);
}

// The closest hits of a framed group, not farther than each ray's length. Returns a bit for each ray that must be cast
// by itself, because there was no room for its leaves.
DEVICE uint traverse_group(Closest* closest, const RayGroup* group, READS(ulong) memory) {
    Runs runs;
    NearLeaves near;
    uint full = 0u;
    for (uint r = 0u; r < group->count; ++r) closest[r] = nothing_hit(group->length[r], group->tolerance[r]);
    find_runs(&runs, group, memory);
    for (uint lost = find_near_leaves(&near, &runs); lost != 0u; lost &= lost - 1u) full |= runs.rays[lowest_bit(lost)];
    for (uint i = 0u; i < near.count; ++i) {
        const uint meets = rays_that_meet(group, near.node[i], near.lane[i]);
        near.meets[i] = runs.rays[near.run[i]] & ~full & meets;
    }
    // The leaves of a fine mesh do not fit the caches.
    for (uint i = 0u; i < near.count; ++i) {
        if (near.meets[i] == 0u) continue;
        for (uint j = 0u; j < 9u; ++j) PREFETCH((GLOBAL const float*)near.block[i], TRIANGLE_LANES * j);
    }
    for (uint i = 0u; i < near.count; i += 4u) {
        for (ulong left = four_sixteens(near.meets, i, near.count); left != 0u; left &= left - 1u) {
            const uint bit = lowest_bit_of_long(left), r = bit % 16u;
            READS(TriangleBlock) block = near.block[i + bit / 16u];
            const RayFrame frame = frame_of(group, r);
            const uint lanes = hit_block(closest + r, &frame, block, group->tolerance[r], true);
            hit_lanes(closest + r, &frame, block, lanes, group->tolerance[r], true);
        }
    }
    return full;
}
