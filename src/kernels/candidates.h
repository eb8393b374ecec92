// SPDX-License-Identifier: Apache-2.0
// The certified method (docs/internals/certified.md): each pair has candidates, the vertex blocks near its target. A
// block is tested only once the pair has moved as far as the block's nearest vertex was from touching. The target's
// clearance grid then tells which of its vertices could be in contact, and until when the others cannot be. hold.h
// tests the bounds.

#define DUE_NOW (-1.0f)            // CandidateBlock.valid_until of a block to be tested in the next step
#define REFRESH_TOLERANCES 8192.0f // some hundredth of the box diagonal

// Begins a new list, whose blocks are tested in the step that made it. places: by pair.
KERNEL void begin_candidates(COUNT(count), READS(PairBlock) near_blocks, READS(uint) firsts, READS(uint) places,
                             WRITES(CandidateBlock) candidates) {
    FOR_EACH(i, count) {
        const PairBlock found = near_blocks[i];
        CandidateBlock candidate;
        candidate.vertex_block = found.vertex_block;
        candidate.valid_until = DUE_NOW;
        candidate.lanes = 0u;
        candidates[places[found.pair] + (i - firsts[found.pair])] = candidate;
    }
}

// The arrays that testing candidates reads and writes.
STRUCT(TestArrays) {
    READS(DirectedPair) pairs;
    READS(ShapeHeader) shapes;
    READS(ulong) memory;
    WRITES(CandidateBlock) candidates;
};

// The result of a block, number `bit` of its segment.
DEVICE CandidateTest test_of(uint lanes, float valid_until, uint bit, uint blocks) {
    const CandidateTest found = {(uint)(lanes != 0u) << bit, valid_until, blocks, bit_count(lanes)};
    return found;
}

// The sum of two results.
DEVICE CandidateTest add_tests(CandidateTest sum, const CandidateTest more) {
    sum.valid_until = more.valid_until < sum.valid_until ? more.valid_until : sum.valid_until;
    sum.blocks += more.blocks;
    sum.rays += more.rays;
    sum.casting |= more.casting;
    return sum;
}

// Tests a block that is due: number `at` of the candidates.
DEVICE_BATCH CandidateTest test_candidate(const TestArrays* in, const Segment segment, uint at) {
    WRITES(CandidateBlock) candidate = in->candidates + at;
    READS(DirectedPair) pair = in->pairs + segment.pair;
    READS(ShapeHeader) target = in->shapes + pair->target;
    READS(VertexBlock) block = source_block(pair, in->shapes, in->memory, candidate->vertex_block);
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
    candidate->lanes = lanes;
    // DUE_NOW is always due, however the clock was rounded.
    candidate->valid_until = least > 0.0f ? segment.now + least : DUE_NOW;
    return test_of(lanes, candidate->valid_until, at - segment.first, 1u);
}

KERNEL void test_candidates(COUNT(count), READS(DirectedPair) pairs, READS(ShapeHeader) shapes, READS(ulong) memory,
                            READS(Segment) segments, WRITES(CandidateBlock) candidates, WRITES(CandidateTest) tests,
                            WRITES(uint) rays) {
    const TestArrays in = {pairs, shapes, memory, candidates};
    FOR_EACH(s, count) {
        const Segment segment = segments[s];
        for (uint line = 0u; line < 3u && s + 4u < count; ++line)
            PREFETCH(candidates, segments[s + 4u].first + 5u * line);
        CandidateTest found = test_of(0u, UNBOUNDED, 0u, 0u);
        for (uint i = segment.first; i < segment.first + segment.count; ++i) {
            const bool valid = candidates[i].valid_until > segment.now;
            found =
                add_tests(found, valid ? test_of(candidates[i].lanes, candidates[i].valid_until, i - segment.first, 0u)
                                       : test_candidate(&in, segment, i));
        }
        tests[s] = found;
        rays[s] = found.rays;
    }
}

// tests: of this step. The rays begin at place `begin`.
KERNEL void write_candidate_rays(COUNT(count), uint begin, READS(Segment) segments, READS(CandidateBlock) candidates,
                                 READS(CandidateTest) tests, READS(uint) firsts, WRITES(Ray) rays) {
    FOR_EACH(s, count) {
        const uint pair = segments[s].pair, first = segments[s].first;
        uint at = begin + firsts[s];
        for (uint casting = tests[s].casting; casting != 0u; casting &= casting - 1u) {
            READS(CandidateBlock) candidate = candidates + first + lowest_bit(casting);
            for (uint lanes = candidate->lanes; lanes != 0u; lanes &= lanes - 1u) {
                rays[at].pair = pair;
                rays[at].vertex_lane = VERTEX_LANES * candidate->vertex_block + lowest_bit(lanes);
                ++at;
            }
        }
    }
}
