// SPDX-License-Identifier: Apache-2.0
// Which vertices of the source lie inside the target's bounds? Clusters of sixteen blocks first, then blocks of
// sixteen vertices, then one dense queue of rays (the paper's padded grid, Fig. 6, would waste lanes).

// Child boxes that may reach into the bounds; grown by the rounding of the transform.
DEVICE uint overlapping_lanes(GLOBAL const OrderedPair* RESTRICT pair, GLOBAL const ClusterBlock* RESTRICT block) {
    float r[9], size[9], t[3], middle[3], half_size[3];
    for (int i = 0; i < 9; ++i) {
        r[i] = pair->rotation[i];
        size[i] = magnitude_of(r[i]);
    }
    for (int i = 0; i < 3; ++i) {
        t[i] = pair->translation[i];
        middle[i] = 0.5f * pair->bounds[i] + 0.5f * pair->bounds[3 + i];
        half_size[i] = 0.5f * pair->bounds[3 + i] - 0.5f * pair->bounds[i];
        half_size[i] += 1.0e-6f * ((half_size[i] + magnitude_of(middle[i])) + magnitude_of(t[i]));
    }
    uint lanes = 0u;
    FOR_LANES(k, VERTEX_LANES) {
        const float cx = block->centre[0][k], cy = block->centre[1][k], cz = block->centre[2][k];
        const float hx = block->half_size[0][k], hy = block->half_size[1][k], hz = block->half_size[2][k];
        const float x = (((r[0] * cx + r[1] * cy) + r[2] * cz) + t[0]) - middle[0];
        const float y = (((r[3] * cx + r[4] * cy) + r[5] * cz) + t[1]) - middle[1];
        const float z = (((r[6] * cx + r[7] * cy) + r[8] * cz) + t[2]) - middle[2];
        const float ex = ((size[0] * hx + size[1] * hy) + size[2] * hz) + half_size[0];
        const float ey = ((size[3] * hx + size[4] * hy) + size[5] * hz) + half_size[1];
        const float ez = ((size[6] * hx + size[7] * hy) + size[8] * hz) + half_size[2];
        const uint overlaps = (x <= ex) & (-x <= ex) & (y <= ey) & (-y <= ey) & (z <= ez) & (-z <= ez);
        lanes |= lane_bit(k) & (0u - overlaps);
    }
    return lanes;
}

// Vertices inside the bounds, exactly as the ray will see them.
DEVICE uint inside_lanes(GLOBAL const OrderedPair* RESTRICT pair, GLOBAL const VertexBlock* RESTRICT block) {
    float r[9], t[3], b[6];
    for (int i = 0; i < 9; ++i) r[i] = pair->rotation[i];
    for (int i = 0; i < 3; ++i) t[i] = pair->translation[i];
    for (int i = 0; i < 6; ++i) b[i] = pair->bounds[i];
    uint lanes = 0u;
    FOR_LANES(k, VERTEX_LANES) {
        const float vx = block->position[0][k], vy = block->position[1][k], vz = block->position[2][k];
        const float x = ((r[0] * vx + r[1] * vy) + r[2] * vz) + t[0];
        const float y = ((r[3] * vx + r[4] * vy) + r[5] * vz) + t[1];
        const float z = ((r[6] * vx + r[7] * vy) + r[8] * vz) + t[2];
        const uint inside = (x >= b[0]) & (x <= b[3]) & (y >= b[1]) & (y <= b[4]) & (z >= b[2]) & (z <= b[5]);
        lanes |= lane_bit(k) & (0u - inside);
    }
    return lanes;
}

// Walks the implicit sixteen-wide tree of clusters, stackless; counts the vertex blocks it reaches and writes them
// from `first` on when asked to.
DEVICE uint reach_clusters(uint p, GLOBAL const OrderedPair* RESTRICT pairs, const ShapeHeader* shape,
                           GLOBAL const ClusterBlock* RESTRICT clusters, const bool write, uint first,
                           GLOBAL Cluster* RESTRICT found) {
    uint count = 0u;
    const uint top = shape->cluster_levels - 1u;
    for (uint root = 0u; root < shape->cluster_count[top]; ++root) {
        uint level = top, at = root;
        ulong trail = 0u;
        uint lanes = overlapping_lanes(pairs + p, clusters + shape->cluster_first[level] + at);
        for (;;) {
            if (lanes == 0u) {
                if (level == top) break;
                ++level;
                at /= VERTEX_LANES;
                lanes = (uint)(trail & 0xffffu);
                trail >>= VERTEX_LANES;
                continue;
            }
            const uint child = VERTEX_LANES * at + lowest_bit(lanes);
            lanes &= lanes - 1u;
            if (level == 0u) {
                if (write) {
                    Cluster cluster;
                    cluster.pair = p;
                    cluster.vertex_block = shape->vertex_block_first + child;
                    cluster.lanes = 0u;
                    found[first + count] = cluster;
                }
                ++count;
            } else {
                trail = (trail << VERTEX_LANES) | (ulong)lanes;
                --level;
                at = child;
                lanes = overlapping_lanes(pairs + p, clusters + shape->cluster_first[level] + at);
            }
        }
    }
    return count;
}

KERNEL void count_clusters(RANGE uint count, GLOBAL const OrderedPair* RESTRICT pairs,
                           GLOBAL const ShapeHeader* RESTRICT shapes, GLOBAL const ClusterBlock* RESTRICT clusters,
                           GLOBAL uint* RESTRICT counts) {
    FOR_EACH(p, count) {
        const ShapeHeader shape = shapes[pairs[p].source];
        counts[p] = reach_clusters(p, pairs, &shape, clusters, false, 0u, (GLOBAL Cluster*)0);
    }
}

KERNEL void write_clusters(RANGE uint count, GLOBAL const OrderedPair* RESTRICT pairs,
                           GLOBAL const ShapeHeader* RESTRICT shapes, GLOBAL const ClusterBlock* RESTRICT clusters,
                           GLOBAL const uint* RESTRICT firsts, GLOBAL Cluster* RESTRICT found) {
    FOR_EACH(p, count) {
        const ShapeHeader shape = shapes[pairs[p].source];
        reach_clusters(p, pairs, &shape, clusters, true, firsts[p], found);
    }
}

KERNEL void count_rays(RANGE uint count, GLOBAL const OrderedPair* RESTRICT pairs,
                       GLOBAL const VertexBlock* RESTRICT vertices, GLOBAL Cluster* RESTRICT clusters,
                       GLOBAL uint* RESTRICT counts) {
    FOR_EACH(i, count) {
        const uint lanes = inside_lanes(pairs + clusters[i].pair, vertices + clusters[i].vertex_block);
        clusters[i].lanes = lanes;
        counts[i] = bit_count(lanes);
    }
}

KERNEL void write_rays(RANGE uint count, GLOBAL const Cluster* RESTRICT clusters, GLOBAL const uint* RESTRICT firsts,
                       GLOBAL Ray* RESTRICT rays) {
    FOR_EACH(i, count) {
        const Cluster cluster = clusters[i];
        uint lanes = cluster.lanes;
        uint at = firsts[i];
        while (lanes != 0u) {
            Ray ray;
            ray.pair = cluster.pair;
            ray.slot = VERTEX_LANES * cluster.vertex_block + lowest_bit(lanes);
            rays[at] = ray;
            ++at;
            lanes &= lanes - 1u;
        }
    }
}
