// SPDX-License-Identifier: Apache-2.0
// The certified method (docs/certified.md): a pair watches the vertex blocks near its target. A block is tested only
// once the pair has moved as far as the block's nearest vertex was from touching. The target's clearance grid then
// tells which of its vertices could be in contact, and until when the others may sleep. hold.h tests the bounds.

#define AWAKE (-1.0f)              // Watch.wake of a block to be tested in the next step
#define REFRESH_TOLERANCES 8192.0f // some hundredth of the box diagonal

// Begins a new list, whose blocks are tested in the step that made it. places: by pair.
KERNEL void begin_watches(COUNT(count), READS(PairBlock) near_blocks, READS(uint) firsts, READS(uint) places,
                          WRITES(Watch) watches) {
    FOR_EACH(i, count) {
        const PairBlock found = near_blocks[i];
        Watch watch;
        watch.vertex_block = found.vertex_block;
        watch.wake = AWAKE;
        watch.lanes = 0u;
        watches[places[found.pair] + (i - firsts[found.pair])] = watch;
    }
}

// The arrays that testing watches reads and writes.
STRUCT(Looking) {
    READS(DirectedPair) pairs;
    READS(ShapeHeader) shapes;
    READS(ulong) memory;
    WRITES(Watch) watches;
};

// The result of a block, number `bit` of its segment.
DEVICE LookResult look_of(uint lanes, float wake, uint bit, uint blocks) {
    const LookResult found = {(uint)(lanes != 0u) << bit, wake, blocks, bit_count(lanes)};
    return found;
}

// The sum of two results.
DEVICE LookResult add_looks(LookResult sum, const LookResult more) {
    sum.wake = more.wake < sum.wake ? more.wake : sum.wake;
    sum.blocks += more.blocks;
    sum.rays += more.rays;
    sum.casting |= more.casting;
    return sum;
}

// Looks at a block that is due: number `at` of the watches.
DEVICE_BATCH LookResult look_at_block(const Looking* in, const Segment segment, uint at) {
    WRITES(Watch) watch = in->watches + at;
    READS(DirectedPair) pair = in->pairs + segment.pair;
    READS(ShapeHeader) target = in->shapes + pair->target;
    READS(VertexBlock) block = source_block(pair, in->shapes, in->memory, watch->vertex_block);
    const InsideLanes placed = inside_lanes(pair, block, 0u);
    float free[VERTEX_LANES];
    safe_lanes(free, &placed, pair, block, 0u, target, in->memory);
    int unsafe[VERTEX_LANES];
    float others[VERTEX_LANES];
    FOR_LANES(k, VERTEX_LANES) {
        const uint safe = (uint)(free[k] > segment.margin);
        unsafe[k] = (int)safe - 1;
        others[k] = safe != 0u ? free[k] : UNBOUNDED;
    }
    const uint lanes = pack_sixteen(unsafe);
    float least = least_of_sixteen(others) - segment.margin;
    // Vertices that cast are tested again after a while: they may no longer need to.
    const float again = REFRESH_TOLERANCES * target->tolerance;
    if (lanes != 0u && least > again) least = again;
    watch->lanes = lanes;
    // AWAKE is never asleep, however the clock was rounded.
    watch->wake = least > 0.0f ? segment.now + least : AWAKE;
    return look_of(lanes, watch->wake, at - segment.first, 1u);
}

KERNEL void look_at_watches(COUNT(count), READS(DirectedPair) pairs, READS(ShapeHeader) shapes, READS(ulong) memory,
                            READS(Segment) segments, WRITES(Watch) watches, WRITES(LookResult) looks,
                            WRITES(uint) rays) {
    const Looking in = {pairs, shapes, memory, watches};
    FOR_EACH(s, count) {
        const Segment segment = segments[s];
        for (uint line = 0u; line < 3u && s + 4u < count; ++line) PREFETCH(watches, segments[s + 4u].first + 5u * line);
        LookResult found = look_of(0u, UNBOUNDED, 0u, 0u);
        for (uint i = segment.first; i < segment.first + segment.count; ++i) {
            const bool asleep = watches[i].wake > segment.now;
            found = add_looks(found, asleep ? look_of(watches[i].lanes, watches[i].wake, i - segment.first, 0u)
                                            : look_at_block(&in, segment, i));
        }
        looks[s] = found;
        rays[s] = found.rays;
    }
}

// looks: of this step. The rays begin at place `begin`.
KERNEL void write_watch_rays(COUNT(count), uint begin, READS(Segment) segments, READS(Watch) watches,
                             READS(LookResult) looks, READS(uint) firsts, WRITES(Ray) rays) {
    FOR_EACH(s, count) {
        const uint pair = segments[s].pair, first = segments[s].first;
        uint at = begin + firsts[s];
        for (uint casting = looks[s].casting; casting != 0u; casting &= casting - 1u) {
            READS(Watch) watch = watches + first + lowest_bit(casting);
            for (uint lanes = watch->lanes; lanes != 0u; lanes &= lanes - 1u) {
                rays[at].pair = pair;
                rays[at].vertex_lane = VERTEX_LANES * watch->vertex_block + lowest_bit(lanes);
                ++at;
            }
        }
    }
}
