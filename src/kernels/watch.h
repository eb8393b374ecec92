// SPDX-License-Identifier: Apache-2.0
// The certified method (docs/certified.md): a pair watches the vertex blocks near its target. Each is looked at only
// once the pair has moved as far as its nearest vertex was from touching (look.h).

#define AWAKE (-1.0f) // of Watch.wake: to be looked at in the next step

// A new list. Blocks that are clearly outside sleep at once, the others are looked at in the step that made the list.
// places, margins: by pair.
KERNEL void begin_watches(COUNT(count), READS(OrderedPair) pairs, READS(ShapeHeader) shapes, READS(ClusterBlock) boxes,
                          READS(uint) clearances, READS(float) margins, READS(PairBlock) near_blocks,
                          READS(uint) firsts, READS(uint) places, WRITES(Watch) watches) {
    FOR_EACH(i, count) {
        const PairBlock found = near_blocks[i];
        READS(OrderedPair) pair = pairs + found.pair;
        const float safe =
            safe_block(pair, shapes + pair->source, boxes, found.vertex_block, shapes + pair->target, clearances)
            - margins[found.pair];
        Watch watch;
        watch.vertex_block = found.vertex_block;
        watch.wake = safe > 0.0f ? safe : AWAKE;
        watch.lanes = 0u;
        watches[places[found.pair] + (i - firsts[found.pair])] = watch;
    }
}

// looks: of this step. The rays begin at place `begin`.
KERNEL void write_watch_rays(COUNT(count), uint begin, READS(Segment) segments, READS(Watch) watches, READS(Look) looks,
                             READS(uint) firsts, WRITES(Ray) rays) {
    FOR_EACH(s, count) {
        const uint pair = segments[s].pair, first = segments[s].first;
        uint at = begin + firsts[s];
        for (uint casting = looks[s].casting; casting != 0u; casting &= casting - 1u) {
            READS(Watch) watch = watches + first + lowest_bit(casting);
            for (uint lanes = watch->lanes; lanes != 0u; lanes &= lanes - 1u) {
                rays[at].pair = pair;
                rays[at].slot = VERTEX_LANES * watch->vertex_block + lowest_bit(lanes);
                ++at;
            }
        }
    }
}
