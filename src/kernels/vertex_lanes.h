// SPDX-License-Identifier: Apache-2.0
// VERTICES_AT_ONCE vertices of a block, in the target's frame.

STRUCT(InsideLanes) {
    float x[VERTICES_AT_ONCE], y[VERTICES_AT_ONCE], z[VERTICES_AT_ONCE]; // target frame
    int inside[VERTICES_AT_ONCE];                                        // -1 or 0
};

// Vertices inside the bounds; their positions have the bits that source_ray() gives.
DEVICE InsideLanes inside_lanes(READS(DirectedPair) pair, READS(VertexBlock) block, uint first) {
    InsideLanes found;
    float r[9], t[3], b[6];
    for (int i = 0; i < 9; ++i) r[i] = pair->rotation[i];
    for (int i = 0; i < 3; ++i) t[i] = pair->translation[i];
    for (int i = 0; i < 6; ++i) b[i] = pair->bounds[i];
    FOR_LANES(k, VERTICES_AT_ONCE) {
        const float vx = block->position[0][first + k], vy = block->position[1][first + k];
        const float vz = block->position[2][first + k];
        const float x = ((r[0] * vx + r[1] * vy) + r[2] * vz) + t[0];
        const float y = ((r[3] * vx + r[4] * vy) + r[5] * vz) + t[1];
        const float z = ((r[6] * vx + r[7] * vy) + r[8] * vz) + t[2];
        const uint inside = (x >= b[0]) & (x <= b[3]) & (y >= b[1]) & (y <= b[4]) & (z >= b[2]) & (z <= b[5]);
        found.inside[k] = -(int)inside;
        found.x[k] = x;
        found.y[k] = y;
        found.z[k] = z;
    }
    return found;
}
