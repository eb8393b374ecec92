// SPDX-License-Identifier: Apache-2.0
// A look at what a pair watches: the blocks that are due are asked of the target's balls, for which vertices could be
// in contact, and until when the others may sleep. The bounds are asked of each ray (hold.h).
//
// NOLINTBEGIN(modernize-redundant-void-arg): this text is C as well

#define REFRESH_TOLERANCES 8192.0f // some hundredth of the box diagonal

// What several looks found together.
DEVICE Look add_looks(Look sum, const Look more) {
    sum.wake = more.wake < sum.wake ? more.wake : sum.wake;
    sum.blocks += more.blocks;
    sum.rays += more.rays;
    sum.casting |= more.casting;
    return sum;
}

DEVICE Look nothing_found(void) {
    Look none;
    none.wake = UNBOUNDED;
    none.blocks = none.rays = 0u;
    none.casting = 0u;
    return none;
}

// What a block casts that is not to be looked at. bit: its place in the segment.
DEVICE Look known_block(uint lanes, float wake, uint bit) {
    Look found = nothing_found();
    found.rays = bit_count(lanes);
    found.casting = (uint)(lanes != 0u) << bit;
    found.wake = wake;
    return found;
}

DEVICE Look look_at_block(uint i, const InsideLanes* placed, const Segment segment, READS(OrderedPair) pair,
                          READS(ShapeHeader) target, READS(VertexBlock) vertices, READS(uint) clearances,
                          WRITES(Watch) watches) {
    WRITES(Watch) watch = watches + i;
    const SafeLanes asked = safe_lanes(placed, pair, vertices + watch->vertex_block, target, clearances);
    int unsafe[VERTEX_LANES];
    float others[VERTEX_LANES];
    FOR_LANES(k, VERTEX_LANES) {
        const uint safe = (uint)(asked.safe[k] > segment.margin);
        unsafe[k] = (int)safe - 1;
        others[k] = safe != 0u ? asked.safe[k] : UNBOUNDED;
    }
    const uint lanes = pack_sixteen(unsafe);
    float least = least_of_sixteen(others) - segment.margin;
    // Vertices that cast are asked again after a while whether they still must.
    const float again = REFRESH_TOLERANCES * target->tolerance;
    if (lanes != 0u && least > again) least = again;
    watch->lanes = lanes;
    // Never asleep, whichever way the clock was rounded.
    watch->wake = least > 0.0f ? segment.now + least : AWAKE;
    Look found = known_block(lanes, watch->wake, i - segment.first);
    found.blocks = 1u;
    return found;
}

// A block that is due. The words of its cells are not near: a grid is large, or the caches went to others since the
// last step. So looks wait for each other: what one reads is under way while others are done.
STRUCT(WaitingLook) {
    uint segment, watch;
    InsideLanes placed;
};

// All of it: what a look leaves its rays will read.
DEVICE void send_for_block(READS(VertexBlock) vertices, uint block) {
    for (uint line = 0u; line < 8u; ++line) PREFETCH((GLOBAL const float*)(vertices + block), VERTEX_LANES * line);
}

DEVICE_BATCH void look_together(WaitingLook* waiting, uint count, READS(OrderedPair) pairs, READS(ShapeHeader) shapes,
                                READS(VertexBlock) vertices, READS(uint) clearances, READS(Segment) segments,
                                WRITES(Watch) watches, WRITES(Look) looks, WRITES(uint) rays) {
    for (uint k = 0u; k < count; ++k) {
        WaitingLook* look = waiting + k;
        READS(OrderedPair) pair = pairs + segments[look->segment].pair;
        look->placed = inside_lanes(pair, vertices + watches[look->watch].vertex_block);
        send_for_words(&look->placed, shapes + pair->target, clearances);
    }
    for (uint k = 0u; k < count; ++k) {
        const uint s = waiting[k].segment;
        READS(OrderedPair) pair = pairs + segments[s].pair;
        const WaitingLook* look = waiting + k;
        looks[s] = add_looks(looks[s], look_at_block(look->watch, &look->placed, segments[s], pair,
                                                     shapes + pair->target, vertices, clearances, watches));
        rays[s] = looks[s].rays;
    }
}

KERNEL void look_at_watches(COUNT(count), READS(OrderedPair) pairs, READS(ShapeHeader) shapes,
                            READS(VertexBlock) vertices, READS(uint) clearances, READS(Segment) segments,
                            WRITES(Watch) watches, WRITES(Look) looks, WRITES(uint) rays) {
    WaitingLook waiting[LOOKS_TOGETHER];
    uint waits = 0u;
    FOR_EACH(s, count) {
        const Segment segment = segments[s];
        if (s + 4u < ALL(count)) {
            PREFETCH(watches, segments[s + 4u].first);
            PREFETCH(watches, segments[s + 4u].first + 5u);
            PREFETCH(watches, segments[s + 4u].first + 10u);
        }
        Look found = nothing_found();
        looks[s] = found;
        for (uint i = segment.first; i < segment.first + segment.count; ++i) {
            if (watches[i].wake > segment.now) {
                found = add_looks(found, known_block(watches[i].lanes, watches[i].wake, i - segment.first));
                continue;
            }
            send_for_block(vertices, watches[i].vertex_block);
            waiting[waits].segment = s;
            waiting[waits].watch = i;
            ++waits;
            if (waits < LOOKS_TOGETHER) continue;
            look_together(waiting, waits, pairs, shapes, vertices, clearances, segments, watches, looks, rays);
            waits = 0u;
        }
        looks[s] = add_looks(looks[s], found);
        rays[s] = looks[s].rays;
    }
    if (LOOKS_TOGETHER > 1)
        look_together(waiting, waits, pairs, shapes, vertices, clearances, segments, watches, looks, rays);
}
// NOLINTEND(modernize-redundant-void-arg)
