// SPDX-License-Identifier: Apache-2.0
// Finds the source's vertices inside the target's bounds, in blocks of sixteen, and writes their rays as one dense list
// (the paper's padded grid, Fig. 6, would waste lanes).

#define LEAST_DEPTH_IN_BALL 0.01f // of a cell: far more than rounding could hide

// Vertices whose cell lies outside a closed mesh need no ray: it would meet the first face from outside.
DEVICE uint outside_lanes(const InsideLanes* found, READS(ShapeHeader) target, READS(ulong) memory) {
    const float scale = target->grid_scale;
    const float low_x = target->grid_low[0], low_y = target->grid_low[1], low_z = target->grid_low[2];
    const uint size_x = target->grid_size[0], size_y = target->grid_size[1];
    READS(uint) words = AT(memory, uint, target->outside_cells);
    int outside[VERTICES_AT_ONCE];
    FOR_LANES(k, VERTICES_AT_ONCE) {
        const bool known = found->inside[k] != 0;
        // Other lanes, which may hold NaN, read the first cell.
        const float px = known ? found->x[k] : low_x, py = known ? found->y[k] : low_y,
                    pz = known ? found->z[k] : low_z;
        const uint x = (uint)(int)((px - low_x) * scale);
        const uint y = (uint)(int)((py - low_y) * scale);
        const uint z = (uint)(int)((pz - low_z) * scale);
        const uint cell = (z * size_y + y) * size_x + x;
        outside[k] = -(int)((words[cell >> 5] >> (cell & 31u)) & 1u);
    }
    return pack_vertices(outside);
}

// Whether a vertex casts a ray, exactly as inside_lanes() decides it. p: from its source_ray(), which has the same
// bits.
DEVICE bool in_bounds(READS(DirectedPair) pair, const float* p) {
    READS(float) b = pair->bounds;
    return ((uint)(p[0] >= b[0]) & (uint)(p[0] <= b[3]) & (uint)(p[1] >= b[1]) & (uint)(p[1] <= b[4])
            & (uint)(p[2] >= b[2]) & (uint)(p[2] <= b[5]))
           != 0u;
}

// Vertices in a ball of the clearance grid that is outside. The outside grid marks whole cells only: about half of the
// vertices that it leaves are outside, too, and their rays are the longest.
DEVICE uint in_ball_lanes(const InsideLanes* found, READS(ShapeHeader) target, READS(ulong) memory) {
    const Clearance grid = clearance_of(target);
    READS(uint) balls = AT(memory, uint, target->clearances);
    int in_ball[VERTICES_AT_ONCE];
    FOR_LANES(k, VERTICES_AT_ONCE) {
        const float safe = safe_distance(grid, balls, found->x[k], found->y[k], found->z[k], UNBOUNDED);
        in_ball[k] = -(int)(safe > LEAST_DEPTH_IN_BALL * grid.cell);
    }
    return pack_vertices(in_ball);
}

// Adds to column 0 of counts the vertices whose rays must be cast, to column 1 all vertices inside the bounds: by the
// paper's rule each of them has a ray.
KERNEL void count_rays(COUNT(count), uint use_grid, uint stride, READS(DirectedPair) pairs, READS(ShapeHeader) shapes,
                       READS(ulong) memory, WRITES(PairBlock) found_blocks, WRITES(uint) counts) {
    FOR_EACH_VERTICES(i, first, count) {
        READS(DirectedPair) pair = pairs + found_blocks[i].pair;
        const InsideLanes found =
            inside_lanes(pair, source_block(pair, shapes, memory, found_blocks[i].vertex_block), first);
        READS(ShapeHeader) target = shapes + pair->target;
        const uint inside_mask = pack_vertices(found.inside);
        if (inside_mask == 0u) continue;
        uint lanes = inside_mask;
        if (use_grid != 0u && target->grid_size[0] != 0u) lanes &= ~outside_lanes(&found, target, memory);
        if (lanes != 0u && use_grid != 0u && target->outward != 0u) lanes &= ~in_ball_lanes(&found, target, memory);
        ADD_TO(&found_blocks[i].lanes, lanes << first);
        ADD_TO(counts + i, bit_count(lanes));
        ADD_TO(counts + stride + i, bit_count(inside_mask));
    }
}

// The part of `lanes`, from `first` on, that an item of FOR_EACH_VERTICES writes.
DEVICE uint own_lanes(uint lanes, uint first) {
    return lanes & (((1u << VERTICES_AT_ONCE) - 1u) << first);
}

// The rays begin at place `begin`.
KERNEL void write_rays(COUNT(count), uint begin, READS(PairBlock) found_blocks, READS(uint) firsts, WRITES(Ray) rays) {
    FOR_EACH_VERTICES(i, first, count) {
        const PairBlock block = found_blocks[i];
        uint at = begin + firsts[i] + bit_count(block.lanes & ((1u << first) - 1u));
        for (uint lanes = own_lanes(block.lanes, first); lanes != 0u; lanes &= lanes - 1u) {
            Ray ray;
            ray.pair = block.pair;
            ray.vertex_lane = VERTEX_LANES * block.vertex_block + lowest_bit(lanes);
            rays[at] = ray;
            ++at;
        }
    }
}
