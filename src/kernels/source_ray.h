// SPDX-License-Identifier: Apache-2.0
// The ray of a vertex, as the target sees it.

STRUCT(SourceRay) {
    float position[3]; // target frame
    float direction[3];
    float reach;
};

DEVICE GLOBAL const VertexBlock* source_block(READS(DirectedPair) pair, READS(ShapeHeader) shapes, READS(ulong) memory,
                                              uint vertex_block) {
    return AT(memory, VertexBlock, shapes[pair->source].vertex_blocks) + vertex_block;
}

// vertex_lane: VERTEX_LANES * vertex block + lane.
DEVICE SourceRay source_ray(READS(DirectedPair) pair, READS(ShapeHeader) shapes, READS(ulong) memory,
                            uint vertex_lane) {
    SourceRay ray;
    READS(VertexBlock) block = source_block(pair, shapes, memory, vertex_lane / VERTEX_LANES);
    const uint lane = vertex_lane % VERTEX_LANES;
    READS(float) r = pair->rotation;
    const float x = block->position[0][lane], y = block->position[1][lane], z = block->position[2][lane];
    const float dx = block->direction[0][lane], dy = block->direction[1][lane], dz = block->direction[2][lane];
    for (int i = 0; i < 3; ++i) {
        ray.position[i] = ((r[3 * i] * x + r[3 * i + 1] * y) + r[3 * i + 2] * z) + pair->translation[i];
        ray.direction[i] = (r[3 * i] * dx + r[3 * i + 1] * dy) + r[3 * i + 2] * dz;
    }
    ray.reach = block->exit[lane];
    return ray;
}
