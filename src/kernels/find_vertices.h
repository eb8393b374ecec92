// SPDX-License-Identifier: Apache-2.0
// Which vertices of the source lie inside the target's bounds? Clusters of sixteen blocks first, then blocks of
// sixteen vertices, then one dense queue of rays (the paper's padded grid, Fig. 6, would waste lanes).
// NOLINTBEGIN(modernize-use-using,modernize-use-nullptr): this text is C as well

// The bounds of a pair as both frames see them: centres and half sizes, grown by the rounding of the transform.
typedef struct {
    float rotation[9], size[9]; // size: magnitudes of the rotation
    float offset[3];            // source origin relative to the middle of the bounds, target frame
    float half_size[3];
    float source_centre[3], source_half_size[3]; // the same box in the source's frame, axis-aligned there
} PairBounds;

DEVICE PairBounds bounds_of(GLOBAL const OrderedPair* RESTRICT pair) {
    PairBounds b;
    for (int i = 0; i < 9; ++i) {
        b.rotation[i] = pair->rotation[i];
        b.size[i] = magnitude_of(b.rotation[i]);
    }
    for (int i = 0; i < 3; ++i) {
        const float middle = 0.5f * pair->bounds[i] + 0.5f * pair->bounds[3 + i];
        const float half_size = 0.5f * pair->bounds[3 + i] - 0.5f * pair->bounds[i];
        b.offset[i] = pair->translation[i] - middle;
        b.half_size[i] =
            half_size + 1.0e-6f * ((half_size + magnitude_of(middle)) + magnitude_of(pair->translation[i]));
    }
    float farthest = 0.0f;
    for (int i = 0; i < 3; ++i) {
        b.source_centre[i] =
            -((b.rotation[i] * b.offset[0] + b.rotation[3 + i] * b.offset[1]) + b.rotation[6 + i] * b.offset[2]);
        const float half_size =
            (b.size[i] * b.half_size[0] + b.size[3 + i] * b.half_size[1]) + b.size[6 + i] * b.half_size[2];
        b.source_half_size[i] = half_size + 1.0e-6f * (half_size + magnitude_of(b.source_centre[i]));
        const float far = magnitude_of(b.source_centre[i]) + half_size;
        farthest = far > farthest ? far : farthest;
    }
    // Poses are rigid to 1e-4 only, and the transpose is as far from the inverse: millimetres on a large slab.
    for (int i = 0; i < 3; ++i) {
        float shear = 0.0f;
        for (int j = 0; j < 3; ++j) {
            const float product = (b.rotation[i] * b.rotation[j] + b.rotation[3 + i] * b.rotation[3 + j])
                                  + b.rotation[6 + i] * b.rotation[6 + j];
            shear += magnitude_of(product - (i == j ? 1.0f : 0.0f));
        }
        b.source_half_size[i] += 1.01f * shear * farthest;
    }
    return b;
}

// Child boxes that may reach into the bounds: no face of either box separates them.
DEVICE uint overlapping_lanes(const PairBounds* b, GLOBAL const ClusterBlock* RESTRICT block) {
    int hit[VERTEX_LANES];
    FOR_LANES(k, VERTEX_LANES) {
        const float cx = block->centre[0][k], cy = block->centre[1][k], cz = block->centre[2][k];
        const float hx = block->half_size[0][k], hy = block->half_size[1][k], hz = block->half_size[2][k];
        const float x = ((b->rotation[0] * cx + b->rotation[1] * cy) + b->rotation[2] * cz) + b->offset[0];
        const float y = ((b->rotation[3] * cx + b->rotation[4] * cy) + b->rotation[5] * cz) + b->offset[1];
        const float z = ((b->rotation[6] * cx + b->rotation[7] * cy) + b->rotation[8] * cz) + b->offset[2];
        const float ex = ((b->size[0] * hx + b->size[1] * hy) + b->size[2] * hz) + b->half_size[0];
        const float ey = ((b->size[3] * hx + b->size[4] * hy) + b->size[5] * hz) + b->half_size[1];
        const float ez = ((b->size[6] * hx + b->size[7] * hy) + b->size[8] * hz) + b->half_size[2];
        const float x_size = magnitude_of(x), y_size = magnitude_of(y), z_size = magnitude_of(z);
        const float away_x = magnitude_of(cx - b->source_centre[0]), away_y = magnitude_of(cy - b->source_centre[1]);
        const float away_z = magnitude_of(cz - b->source_centre[2]);
        const uint in_target = (x_size <= ex) & (y_size <= ey) & (z_size <= ez);
        const uint in_source = (away_x <= hx + b->source_half_size[0]) & (away_y <= hy + b->source_half_size[1])
                               & (away_z <= hz + b->source_half_size[2]);
        hit[k] = -(int)(in_target & in_source);
    }
    return pack_sixteen(hit);
}

typedef struct {
    float x[VERTEX_LANES], y[VERTEX_LANES], z[VERTEX_LANES]; // target frame
    int inside[VERTEX_LANES];                                // -1 or 0
} InsideLanes;

// Vertices inside the bounds, exactly as the ray will see them.
DEVICE InsideLanes inside_lanes(GLOBAL const OrderedPair* RESTRICT pair, GLOBAL const VertexBlock* RESTRICT block) {
    InsideLanes found;
    float r[9], t[3], b[6];
    for (int i = 0; i < 9; ++i) r[i] = pair->rotation[i];
    for (int i = 0; i < 3; ++i) t[i] = pair->translation[i];
    for (int i = 0; i < 6; ++i) b[i] = pair->bounds[i];
    FOR_LANES(k, VERTEX_LANES) {
        const float vx = block->position[0][k], vy = block->position[1][k], vz = block->position[2][k];
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

// Those whose cell is known to lie outside a closed mesh need no ray: the first face they could meet is met from
// outside.
DEVICE uint outside_lanes(const InsideLanes* found, GLOBAL const ShapeHeader* RESTRICT target,
                          GLOBAL const uint* RESTRICT outside_cells) {
    const float scale = target->grid_scale;
    const float low_x = target->grid_low[0], low_y = target->grid_low[1], low_z = target->grid_low[2];
    const uint size_x = target->grid_size[0], size_y = target->grid_size[1];
    GLOBAL const uint* RESTRICT words = outside_cells + target->grid_first;
    int outside[VERTEX_LANES];
    FOR_LANES(k, VERTEX_LANES) {
        const bool known = found->inside[k] != 0;
        // Other lanes, which may hold NaN, look at the first cell.
        const float px = known ? found->x[k] : low_x, py = known ? found->y[k] : low_y,
                    pz = known ? found->z[k] : low_z;
        const uint x = (uint)(int)((px - low_x) * scale);
        const uint y = (uint)(int)((py - low_y) * scale);
        const uint z = (uint)(int)((pz - low_z) * scale);
        const uint cell = (z * size_y + y) * size_x + x;
        outside[k] = -(int)((words[cell >> 5] >> (cell & 31u)) & 1u);
    }
    return pack_sixteen(outside);
}

// Shapes of up to this many vertex blocks keep the answer of the counting pass in one word.
#define SMALL_BLOCKS 64u

DEVICE Cluster cluster_at(uint pair, uint vertex_block) {
    Cluster cluster;
    cluster.pair = pair;
    cluster.vertex_block = vertex_block;
    cluster.lanes = 0u;
    return cluster;
}

// Walks the implicit sixteen-wide tree of clusters, stackless; counts the vertex blocks it reaches and writes them
// from `first` on when asked to.
DEVICE uint reach_clusters(uint p, GLOBAL const OrderedPair* RESTRICT pairs, GLOBAL const ShapeHeader* RESTRICT shape,
                           GLOBAL const ClusterBlock* RESTRICT clusters, const bool write, uint first,
                           GLOBAL Cluster* RESTRICT found) {
    const PairBounds bounds = bounds_of(pairs + p);
    uint count = 0u;
    const uint top = shape->cluster_levels - 1u;
    for (uint root = 0u; root < shape->cluster_count[top]; ++root) {
        uint level = top, at = root;
        ulong trail = 0u;
        uint lanes = overlapping_lanes(&bounds, clusters + shape->cluster_first[level] + at);
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
                if (write) found[first + count] = cluster_at(p, shape->vertex_block_first + child);
                ++count;
            } else {
                trail = (trail << VERTEX_LANES) | (ulong)lanes;
                --level;
                at = child;
                lanes = overlapping_lanes(&bounds, clusters + shape->cluster_first[level] + at);
            }
        }
    }
    return count;
}

KERNEL void count_clusters(RANGE uint count, GLOBAL const OrderedPair* RESTRICT pairs,
                           GLOBAL const ShapeHeader* RESTRICT shapes, GLOBAL const ClusterBlock* RESTRICT clusters,
                           GLOBAL uint* RESTRICT counts, GLOBAL ulong* RESTRICT small) {
    FOR_EACH(p, count) {
        GLOBAL const ShapeHeader* shape = shapes + pairs[p].source;
        if (shape->vertex_block_count <= SMALL_BLOCKS) {
            const PairBounds bounds = bounds_of(pairs + p);
            ulong blocks = 0u;
            uint number = 0u;
            for (uint i = 0u; i < shape->cluster_count[0]; ++i) {
                const uint lanes = overlapping_lanes(&bounds, clusters + shape->cluster_first[0] + i);
                blocks |= (ulong)lanes << (VERTEX_LANES * i);
                number += bit_count(lanes);
            }
            small[p] = blocks;
            counts[p] = number;
        } else {
            counts[p] = reach_clusters(p, pairs, shape, clusters, false, 0u, (GLOBAL Cluster*)0);
        }
    }
}

KERNEL void write_clusters(RANGE uint count, GLOBAL const OrderedPair* RESTRICT pairs,
                           GLOBAL const ShapeHeader* RESTRICT shapes, GLOBAL const ClusterBlock* RESTRICT clusters,
                           GLOBAL const ulong* RESTRICT small, GLOBAL const uint* RESTRICT firsts,
                           GLOBAL Cluster* RESTRICT found) {
    FOR_EACH(p, count) {
        GLOBAL const ShapeHeader* shape = shapes + pairs[p].source;
        if (shape->vertex_block_count <= SMALL_BLOCKS) {
            uint at = firsts[p];
            for (uint i = 0u; i < shape->cluster_count[0]; ++i) {
                uint lanes = (uint)(small[p] >> (VERTEX_LANES * i)) & 0xffffu;
                while (lanes != 0u) {
                    found[at] = cluster_at(p, shape->vertex_block_first + VERTEX_LANES * i + lowest_bit(lanes));
                    ++at;
                    lanes &= lanes - 1u;
                }
            }
        } else {
            reach_clusters(p, pairs, shape, clusters, true, firsts[p], found);
        }
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
        GLOBAL const ShapeHeader* target = shapes + pair->target;
        const uint inside_mask = pack_sixteen(found.inside);
        uint lanes = inside_mask;
        if (lanes != 0u && use_grid != 0u && target->grid_size[0] != 0u)
            lanes &= ~outside_lanes(&found, target, outside_cells);
        clusters[i].lanes = lanes;
        inside[i] = bit_count(inside_mask);
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
// NOLINTEND(modernize-use-using,modernize-use-nullptr)
