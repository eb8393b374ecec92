// SPDX-License-Identifier: Apache-2.0
// The certified method (docs/certified.md): a pair watches the vertex blocks near its target. Each is looked at only
// once the pair has moved as far as its nearest vertex was from touching (look.h).

#define AWAKE (-1.0f) // of Watch.wake: to be looked at in the next step

// A new list. Blocks that are clearly outside sleep at once, the others are looked at in the step that made the list.
// places, margins: by pair.
KERNEL void begin_watches(RANGE uint count, GLOBAL const OrderedPair* RESTRICT pairs,
                          GLOBAL const ShapeHeader* RESTRICT shapes, GLOBAL const ClusterBlock* RESTRICT boxes,
                          GLOBAL const uint* RESTRICT clearances, GLOBAL const float* RESTRICT margins,
                          GLOBAL const Cluster* RESTRICT clusters, GLOBAL const uint* RESTRICT firsts,
                          GLOBAL const uint* RESTRICT places, GLOBAL Watch* RESTRICT watches) {
    FOR_EACH(i, count) {
        const Cluster cluster = clusters[i];
        GLOBAL const OrderedPair* pair = pairs + cluster.pair;
        const float safe =
            safe_block(pair, shapes + pair->source, boxes, cluster.vertex_block, shapes + pair->target, clearances)
            - margins[cluster.pair];
        Watch watch;
        watch.vertex_block = cluster.vertex_block;
        watch.wake = safe > 0.0f ? safe : AWAKE;
        watch.lanes = 0u;
        watches[places[cluster.pair] + (i - firsts[cluster.pair])] = watch;
    }
}

// looks: of this step; before: the rays of the last one.
KERNEL void write_watch_rays(RANGE uint count, GLOBAL const Segment* RESTRICT segments,
                             GLOBAL const Watch* RESTRICT watches, GLOBAL const Look* RESTRICT looks,
                             GLOBAL const Ray* RESTRICT before, GLOBAL const uint* RESTRICT firsts,
                             GLOBAL Ray* RESTRICT rays) {
    FOR_EACH(s, count) {
        const uint pair = segments[s].pair, first = segments[s].first;
        uint at = firsts[s];
        for (uint i = 0u; i < segments[s].rays; ++i) {
            rays[at + i].pair = pair;
            rays[at + i].slot = before[first + i].slot;
        }
        for (ulong casting = looks[s].casting; casting != 0u; casting &= casting - 1u) {
            GLOBAL const Watch* RESTRICT watch = watches + first + lowest_bit_of_long(casting);
            for (uint lanes = watch->lanes; lanes != 0u; lanes &= lanes - 1u) {
                rays[at].pair = pair;
                rays[at].slot = VERTEX_LANES * watch->vertex_block + lowest_bit(lanes);
                ++at;
            }
        }
    }
}
