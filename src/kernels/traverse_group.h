// SPDX-License-Identifier: Apache-2.0
// Short rays, several at a time, where RAYS_IN_GROUP is more than 1: on a CPU. A single ray must finish each test
// before it knows the next one. Here each stage is done for all rays before the next stage begins, so that hardly any
// branch depends on an unfinished test.

#define GROUP_TRIANGLES (4 * RAYS_IN_GROUP) // one or two for a ray

// Triangles that passed the block test, each to be tested by hit_lane()'s operations against its ray.
STRUCT(TriangleTests) {
    uint visit[GROUP_TRIANGLES], lane[GROUP_TRIANGLES];
    uint count;
};

// hit_lane() for all of them, sixteen at a time.
DEVICE void test_triangles(Closest* closest, const Group* group, const Visits* leaves, const TriangleTests* tests,
                           READS(TriangleBlock) blocks) {
    for (uint first = 0u; first < tests->count; first += TRIANGLE_LANES) {
        const uint left = tests->count - first, few = left < TRIANGLE_LANES ? left : TRIANGLE_LANES;
        float corner[9][TRIANGLE_LANES], origin[3][TRIANGLE_LANES], shear[3][TRIANGLE_LANES], t[TRIANGLE_LANES];
        int met[TRIANGLE_LANES], back[TRIANGLE_LANES];
        for (uint k = 0u; k < TRIANGLE_LANES; ++k) {
            const uint i = first + (k < few ? k : 0u), visit = tests->visit[i], r = leaves->who[visit];
            const uint lane = tests->lane[i];
            READS(TriangleBlock) block = blocks + leaves->at[visit];
            for (uint j = 0u; j < 3u; ++j) {
                const uint axis = group->axis[j][r];
                for (uint c = 0u; c < 3u; ++c) corner[3u * c + j][k] = block->corner[3u * c + axis][lane];
                origin[j][k] = group->origin[j][r];
                shear[j][k] = group->shear[j][r];
            }
        }
        FOR_LANES(k, TRIANGLE_LANES) {
            const float ox = origin[0][k], oy = origin[1][k], oz = origin[2][k];
            const float az = corner[2][k] - oz, bz = corner[5][k] - oz, cz = corner[8][k] - oz;
            const Edges e = edges_of(corner[0][k] - ox, corner[1][k] - oy, az, corner[3][k] - ox, corner[4][k] - oy, bz,
                                     corner[6][k] - ox, corner[7][k] - oy, cz, shear[0][k], shear[1][k]);
            const float area = area_of(e);
            const int front = (e.u >= 0.0f) & (e.v >= 0.0f) & (e.w >= 0.0f);
            back[k] = (e.u <= 0.0f) & (e.v <= 0.0f) & (e.w <= 0.0f);
            met[k] = (front | back[k]) & (int)(area != 0.0f);
            t[k] = distance_of(e, az, bz, cz, shear[2][k]);
        }
        for (uint k = 0u; k < few; ++k) {
            const uint i = first + k, visit = tests->visit[i], r = leaves->who[visit];
            if (met[k] != 0)
                accept_hit(closest + r, t[k], back[k] != 0, blocks[leaves->at[visit]].triangle[tests->lane[i]],
                           group->tolerance[r]);
        }
    }
}

// The closest hits of a framed group, not farther than each ray's length. Returns a bit for each ray that must be cast
// by itself, because there was no room for its leaves or triangles.
DEVICE uint traverse_group(Closest* closest, const Group* group, READS(Node) nodes, READS(TriangleBlock) blocks) {
    Runs runs;
    NearLeaves near;
    Visits leaves;
    TriangleTests tests;
    uint hit[GROUP_VISITS];
    uint full = 0u;
    for (uint r = 0u; r < group->count; ++r) closest[r] = nothing_hit(group->length[r], group->tolerance[r]);
    find_runs(&runs, group);
    for (uint lost = find_near_leaves(&near, &runs, nodes); lost != 0u; lost &= lost - 1u)
        full |= runs.rays[lowest_bit(lost)];
    for (uint i = 0u; i < near.count; ++i) {
        const uint meets = rays_that_meet(group, nodes + near.node[i], near.lane[i]);
        near.meets[i] = runs.rays[near.run[i]] & ~full & meets;
    }
    // Of a fine mesh the leaves lie beyond the caches.
    for (uint i = 0u; i < near.count; ++i) {
        if (near.meets[i] == 0u) continue;
        for (uint j = 0u; j < 9u; ++j) PREFETCH((GLOBAL const float*)(blocks + near.block[i]), TRIANGLE_LANES * j);
    }
    leaves.count = 0u;
    for (uint i = 0u; i < near.count; i += 4u) {
        ulong left = four_sixteens(near.meets, i, near.count);
        if (leaves.count + bit_count_of_long(left) > GROUP_VISITS) {
            for (uint j = i; j < i + 4u && j < near.count; ++j) full |= near.meets[j];
            continue;
        }
        for (; left != 0u; left &= left - 1u) {
            const uint bit = lowest_bit_of_long(left), j = i + bit / 16u;
            leaves.who[leaves.count] = bit % 16u;
            leaves.at[leaves.count] = near.block[j];
            leaves.count += 1u;
        }
    }
    for (uint i = 0u; i < leaves.count; ++i) {
        const uint r = leaves.who[i];
        const RayFrame frame = frame_of(group, r);
        hit[i] = hit_block(closest + r, &frame, blocks + leaves.at[i], group->tolerance[r], true);
    }
    tests.count = 0u;
    for (uint i = 0u; i < leaves.count; i += 4u) {
        ulong left = four_sixteens(hit, i, leaves.count);
        for (; left != 0u; left &= left - 1u) {
            const uint bit = lowest_bit_of_long(left), j = i + bit / 16u;
            if (tests.count == GROUP_TRIANGLES) {
                full |= 1u << leaves.who[j];
                continue;
            }
            tests.visit[tests.count] = j;
            tests.lane[tests.count] = bit % 16u;
            tests.count += 1u;
        }
    }
    test_triangles(closest, group, &leaves, &tests, blocks);
    return full;
}
