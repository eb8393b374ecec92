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

typedef struct {
    float x[VERTEX_LANES], y[VERTEX_LANES], z[VERTEX_LANES]; // target frame
    uint lanes;
} InsideLanes;

// Vertices inside the bounds, exactly as the ray will see them.
DEVICE InsideLanes inside_lanes(GLOBAL const OrderedPair* RESTRICT pair, GLOBAL const VertexBlock* RESTRICT block) {
    InsideLanes found;
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
        found.x[k] = x;
        found.y[k] = y;
        found.z[k] = z;
    }
    found.lanes = lanes;
    return found;
}

// Those whose cell is known to lie outside a closed mesh need no ray: the first face they could meet is met from
// outside.
DEVICE uint outside_lanes(const InsideLanes* found, const ShapeHeader* target,
                          GLOBAL const uint* RESTRICT outside_cells) {
    const float scale = target->grid_scale;
    const float low_x = target->grid_low[0], low_y = target->grid_low[1], low_z = target->grid_low[2];
    const uint size_x = target->grid_size[0], size_y = target->grid_size[1];
    const uint inside = found->lanes;
    GLOBAL const uint* RESTRICT words = outside_cells + target->grid_first;
    uint lanes = 0u;
    FOR_LANES(k, VERTEX_LANES) {
        const bool known = (inside & lane_bit(k)) != 0u;
        // Other lanes, which may hold NaN, look at the first cell.
        const float px = known ? found->x[k] : low_x, py = known ? found->y[k] : low_y,
                    pz = known ? found->z[k] : low_z;
        const uint x = (uint)(int)((px - low_x) * scale);
        const uint y = (uint)(int)((py - low_y) * scale);
        const uint z = (uint)(int)((pz - low_z) * scale);
        const uint cell = (z * size_y + y) * size_x + x;
        const uint outside = (words[cell >> 5] >> (cell & 31u)) & 1u;
        lanes |= lane_bit(k) & (0u - outside);
    }
    return lanes & inside;
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

// inside: vertices in the bounds, one ray of the rule each. counts: those whose ray must be cast to know.
KERNEL void count_rays(RANGE uint count, uint use_grid, GLOBAL const OrderedPair* RESTRICT pairs,
                       GLOBAL const ShapeHeader* RESTRICT shapes, GLOBAL const VertexBlock* RESTRICT vertices,
                       GLOBAL const uint* RESTRICT outside_cells, GLOBAL Cluster* RESTRICT clusters,
                       GLOBAL uint* RESTRICT inside, GLOBAL uint* RESTRICT counts) {
    FOR_EACH(i, count) {
        GLOBAL const OrderedPair* pair = pairs + clusters[i].pair;
        const InsideLanes found = inside_lanes(pair, vertices + clusters[i].vertex_block);
        const ShapeHeader target = shapes[pair->target];
        uint lanes = found.lanes;
        if (lanes != 0u && use_grid != 0u && target.grid_size[0] != 0u)
            lanes &= ~outside_lanes(&found, &target, outside_cells);
        clusters[i].lanes = lanes;
        inside[i] = bit_count(found.lanes);
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
