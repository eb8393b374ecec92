// SPDX-License-Identifier: Apache-2.0
// Finds the blocks of sixteen vertices or edges that may reach into the target's bounds, by a tree of boxes, sixteen to
// a node.

// The bounds of a pair in both frames: centres and half sizes, grown by the rounding of the transform.
STRUCT(PairBounds) {
    float rotation[9], size[9]; // size: magnitudes of the rotation
    float offset[3];            // source origin relative to the middle of the bounds, target frame
    float half_size[3];
    float source_centre[3], source_half_size[3]; // the same box in the source's frame, axis-aligned there
};

DEVICE PairBounds bounds_of(READS(DirectedPair) pair) {
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
    // Poses are rigid only to 1e-4, so the transpose differs from the inverse: by millimetres on a large slab.
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

// Child boxes that may reach into the bounds: no face normal of either box separates them.
DEVICE uint overlapping_lanes(const PairBounds* b, READS(ClusterBlock) block) {
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

// A search for the blocks of pair p in its source's tree of clusters, and what the boxes are compared with.
STRUCT(Search) {
    uint p;
    READS(DirectedPair) pair;
    READS(SourceTree) source;
    READS(ShapeHeader) target;
    READS(ClusterBlock) clusters; // of the source
    READS(uint) balls;            // of the target
    float horizon;
    EdgeChoice choice;
    float reach;      // of the sources' rays, as safe_distance() takes it; not known of vertices
    float least_safe; // of the boxes left out
};

// Child boxes with a point that could be in contact before it has moved by `horizon`, by the balls around the boxes: of
// vertices only a middle that is outside gives a bound. A point outside the bounds cannot be in contact before it
// reaches them. Poses are rigid only to 1e-4 each and may stretch a box by more than the margin, hence the half
// thousandth.
DEVICE uint near_lanes(Search* search, READS(ClusterBlock) block) {
    READS(DirectedPair) pair = search->pair;
    READS(ShapeHeader) target = search->target;
    const Clearance grid = clearance_of(target);
    float r[9], t[3], b[6];
    for (int i = 0; i < 9; ++i) r[i] = pair->rotation[i];
    for (int i = 0; i < 3; ++i) t[i] = pair->translation[i];
    for (int i = 0; i < 6; ++i) b[i] = pair->bounds[i];
    int within[VERTEX_LANES];
    float beyond[VERTEX_LANES];
    FOR_LANES(k, VERTEX_LANES) {
        const float cx = block->centre[0][k], cy = block->centre[1][k], cz = block->centre[2][k];
        const float hx = block->half_size[0][k], hy = block->half_size[1][k], hz = block->half_size[2][k];
        const float x = ((r[0] * cx + r[1] * cy) + r[2] * cz) + t[0];
        const float y = ((r[3] * cx + r[4] * cy) + r[5] * cz) + t[1];
        const float z = ((r[6] * cx + r[7] * cy) + r[8] * cz) + t[2];
        const float free = safe_distance(grid, search->balls, x, y, z, search->reach), gap = bounds_gap(b, x, y, z);
        const float away = (free > gap ? free : gap) - 1.0005f * root_of((hx * hx + hy * hy) + hz * hz);
        const float hides = block->hides[k];
        const float safe = away + (hides < search->choice.least_ahead ? search->choice.ahead : 0.0f);
        const uint counts = (uint)(hides >= search->choice.least);
        const uint reached = counts & (uint)(safe <= search->horizon);
        within[k] = -(int)reached;
        const uint passed_over = counts & (uint)(safe > search->horizon); // false for NaN, in empty lanes
        beyond[k] = passed_over != 0u ? safe : UNBOUNDED;
    }
    const float least = least_of_sixteen(beyond);
    search->least_safe = least < search->least_safe ? least : search->least_safe;
    return pack_sixteen(within);
}

// choices: by pair; null for all edges alike.
DEVICE EdgeChoice choice_of(READS(EdgeChoice) choices, uint p) {
    const EdgeChoice all = {0.0f, 0.0f, 0.0f};
    if (!choices) return all;
    return choices[p];
}

// Without horizons the horizon is negative.
DEVICE Search search_of(uint p, uint edges, READS(DirectedPair) pairs, READS(float) horizons, READS(EdgeChoice) choices,
                        READS(ShapeHeader) shapes, READS(ulong) memory) {
    READS(DirectedPair) pair = pairs + p;
    READS(ShapeHeader) source = shapes + pair->source;
    READS(ShapeHeader) target = shapes + pair->target;
    const Search search = {p,
                           pair,
                           edges == 1u ? &source->edges : &source->vertices,
                           target,
                           AT(memory, ClusterBlock, source->clusters),
                           AT(memory, uint, target->clearances),
                           horizons ? horizons[p] : -1.0f,
                           choice_of(choices, p),
                           edges != 0u ? 0.0f : UNBOUNDED,
                           UNBOUNDED};
    return search;
}

DEVICE uint reached_lanes(Search* search, const PairBounds* bounds, const bool by_horizon, uint level, uint at) {
    READS(ClusterBlock) block = search->clusters + search->source->cluster_first[level] + at;
    return by_horizon ? near_lanes(search, block) : overlapping_lanes(bounds, block);
}

// For a source of up to this many blocks the counting pass keeps its result in words, a bit for each block.
#define BLOCKS_IN_MASK (64u * MASK_WORDS)

// Where the blocks of a pair are written, and the two columns of ray counts, which begin at 0 (count_rays()). mask: if
// not null, the blocks are only marked there.
STRUCT(FoundBlocks) {
    WRITES(PairBlock) blocks;
    WRITES(uint) ray_counts;
    uint stride;
    WRITES(ulong) mask;
};

DEVICE void write_block(const FoundBlocks* found, uint at, const Search* search, uint block) {
    if (found->mask) {
        found->mask[block / 64u] |= (ulong)1u << (block % 64u);
        return;
    }
    const PairBlock own = {search->p, search->source->block_first + block, 0u, NONE};
    found->blocks[at] = own;
    found->ray_counts[at] = 0u;
    found->ray_counts[found->stride + at] = 0u;
}

// Traverses the implicit sixteen-wide tree of clusters without a stack. Counts the vertex blocks it reaches and writes
// them if `found` is not null.
DEVICE uint reach_clusters(Search* search, const PairBounds* bounds, const bool by_horizon, const FoundBlocks* found) {
    uint count = 0u;
    const uint top = search->source->cluster_levels - 1u;
    for (uint root = 0u; root < search->source->cluster_count[top]; ++root) {
        uint level = top, at = root;
        ulong trail = 0u;
        uint lanes = reached_lanes(search, bounds, by_horizon, level, at);
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
                if (found) write_block(found, count, search, child);
                ++count;
            } else {
                trail = (trail << VERTEX_LANES) | (ulong)lanes;
                --level;
                at = child;
                lanes = reached_lanes(search, bounds, by_horizon, level, at);
            }
        }
    }
    return count;
}

// mask: the blocks found, a bit each, if the source has at most BLOCKS_IN_MASK.
DEVICE uint count_reached(Search* search, const bool by_horizon, WRITES(ulong) mask) {
    const PairBounds bounds = bounds_of(search->pair);
    // NOLINTNEXTLINE(modernize-use-nullptr): this text is C as well
    const FoundBlocks marked = {(GLOBAL PairBlock*)0, (GLOBAL uint*)0, 0u, mask};
    if (search->source->block_count > BLOCKS_IN_MASK)
        // NOLINTNEXTLINE(modernize-use-nullptr): this text is C as well
        return reach_clusters(search, &bounds, by_horizon, (const FoundBlocks*)0);
    const uint words = (search->source->block_count + 63u) / 64u;
    for (uint w = 0u; w < words; ++w) mask[w] = 0u;
    if (words > 1u) return reach_clusters(search, &bounds, by_horizon, &marked);
    ulong blocks = 0u;
    for (uint i = 0u; i < search->source->cluster_count[0]; ++i)
        blocks |= (ulong)reached_lanes(search, &bounds, by_horizon, 0u, i) << (VERTEX_LANES * i);
    if (words > 0u) *mask = blocks;
    return bit_count_of_long(blocks);
}

DEVICE void write_reached(Search* search, READS(ulong) mask, const FoundBlocks* found) {
    if (search->source->block_count <= BLOCKS_IN_MASK) {
        uint at = 0u;
        for (uint first = 0u; first < search->source->block_count; first += 64u)
            for (ulong left = mask[first / 64u]; left != 0u; left &= left - 1u) {
                write_block(found, at, search, first + lowest_bit_of_long(left));
                ++at;
            }
        return;
    }
    const PairBounds bounds = bounds_of(search->pair);
    if (search->horizon < 0.0f)
        reach_clusters(search, &bounds, false, found);
    else
        reach_clusters(search, &bounds, true, found);
}

// Counts the vertex blocks of each pair that may reach into the bounds. With horizons (metres, by pair) it leaves out
// blocks that cannot be in contact before they have moved that far. safe_distances, with horizons: for a pair without
// blocks, a lower bound of how far its vertices can move before one could be in contact; may be negative. choices: of
// edges, with horizons; null for all. edges: what is searched, as BlockSearch::Sources: 0 vertices that cast, 1 edges,
// 2 vertices as points; edges and points are in contact where they meet the surface.
KERNEL void count_clusters(COUNT(count), uint edges, READS(DirectedPair) pairs, READS(float) horizons,
                           READS(EdgeChoice) choices, READS(ShapeHeader) shapes, READS(ulong) memory,
                           WRITES(uint) counts, WRITES(float) safe_distances, WRITES(ulong) block_masks) {
    FOR_EACH(p, count) {
        if (pairs[p].source == NONE) {
            counts[p] = 0u;
            continue;
        }
        Search search = search_of(p, edges, pairs, horizons, choices, shapes, memory);
        counts[p] = search.horizon < 0.0f ? count_reached(&search, false, block_masks + MASK_WORDS * p)
                                          : count_reached(&search, true, block_masks + MASK_WORDS * p);
        if (horizons) safe_distances[p] = search.least_safe;
    }
}

KERNEL void write_clusters(COUNT(count), uint edges, READS(DirectedPair) pairs, READS(float) horizons,
                           READS(EdgeChoice) choices, READS(ShapeHeader) shapes, READS(ulong) memory,
                           READS(ulong) block_masks, READS(uint) firsts, WRITES(PairBlock) blocks, uint stride,
                           WRITES(uint) ray_counts) {
    FOR_EACH(p, count) {
        if (pairs[p].source == NONE) continue;
        Search search = search_of(p, edges, pairs, horizons, choices, shapes, memory);
        // NOLINTNEXTLINE(modernize-use-nullptr): this text is C as well
        const FoundBlocks found = {blocks + firsts[p], ray_counts + firsts[p], stride, (GLOBAL ulong*)0};
        write_reached(&search, block_masks + MASK_WORDS * p, &found);
    }
}
