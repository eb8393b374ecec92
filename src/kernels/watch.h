// SPDX-License-Identifier: Apache-2.0
// The certified method (docs/certified.md): a pair watches the vertex blocks near its target. Each is looked at only
// once the pair has moved as far as its nearest vertex was from touching.
// NOLINTBEGIN(modernize-use-using): this text is C as well

#define REFRESH_TOLERANCES 8192.0f // some hundredth of the box diagonal
#define AWAKE (-1.0f)              // of Watch.wake: to be looked at in every step

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
        watch.cast = 0u;
        watches[places[cluster.pair] + (i - firsts[cluster.pair])] = watch;
    }
}

KERNEL void look_at_watches(RANGE uint count, GLOBAL const OrderedPair* RESTRICT pairs,
                            GLOBAL const ShapeHeader* RESTRICT shapes, GLOBAL const VertexBlock* RESTRICT vertices,
                            GLOBAL const uint* RESTRICT outside_cells, GLOBAL const uint* RESTRICT clearances,
                            GLOBAL const Segment* RESTRICT segments, GLOBAL Watch* RESTRICT watches,
                            GLOBAL Look* RESTRICT looks, GLOBAL uint* RESTRICT rays) {
    FOR_EACH(s, count) {
        const Segment segment = segments[s];
        GLOBAL const OrderedPair* pair = pairs + segment.pair;
        GLOBAL const ShapeHeader* target = shapes + pair->target;
        float wake = UNBOUNDED;
        uint looked_at = 0u, inside = 0u, ray_count = 0u;
        ulong casting = 0u;
        if (s + 4u < count) {
            PREFETCH(watches, segments[s + 4u].first);
            PREFETCH(watches, segments[s + 4u].first + 4u);
            PREFETCH(watches, segments[s + 4u].first + 8u);
        }
        for (uint i = segment.first; i < segment.first + segment.count; ++i) {
            float own = watches[i].wake;
            uint lanes = watches[i].lanes;
            if (own > segment.now && lanes == 0u) {
                if (own < wake) wake = own;
                continue;
            }
            GLOBAL const VertexBlock* RESTRICT block = vertices + watches[i].vertex_block;
            const InsideLanes held = inside_lanes(pair, block);
            const bool ask = own <= segment.now;
            if (ask) {
                const SafeLanes found = safe_lanes(&held, pair, block, target, clearances);
                int unsafe[VERTEX_LANES];
                float others[VERTEX_LANES];
                FOR_LANES(k, VERTEX_LANES) {
                    const uint safe = (uint)(found.safe[k] > segment.margin);
                    unsafe[k] = (int)safe - 1;
                    others[k] = safe != 0u ? found.safe[k] : UNBOUNDED;
                }
                lanes = pack_sixteen(unsafe);
                watches[i].lanes = lanes;
                looked_at += 1u;
                float least = least_of_sixteen(others) - segment.margin;
                // Vertices that cast are asked again after a while whether they still must.
                const float again = REFRESH_TOLERANCES * target->tolerance;
                if (lanes != 0u && least > again) least = again;
                // Never asleep, whichever way the clock was rounded.
                own = least > 0.0f ? segment.from + least : AWAKE;
                watches[i].wake = own;
            }
            if (lanes != 0u) {
                uint cast = lanes & pack_sixteen(held.inside);
                inside += bit_count(cast);
                // Where the balls were asked just now, the bits know no more.
                if (cast != 0u && !ask && target->grid_size[0] != 0u)
                    cast &= ~outside_lanes(&held, target, outside_cells);
                ray_count += bit_count(cast);
                watches[i].cast = cast;
                casting |= (ulong)(cast != 0u) << (i - segment.first);
                own = AWAKE;
            }
            if (own < wake) wake = own;
        }
        looks[s].wake = wake;
        looks[s].blocks = looked_at;
        looks[s].inside = inside;
        looks[s].rays = ray_count;
        looks[s].casting = casting;
        rays[s] = ray_count;
    }
}

// looks: of this step.
KERNEL void write_watch_rays(RANGE uint count, GLOBAL const Segment* RESTRICT segments,
                             GLOBAL const Watch* RESTRICT watches, GLOBAL const Look* RESTRICT looks,
                             GLOBAL const uint* RESTRICT firsts, GLOBAL Ray* RESTRICT rays) {
    FOR_EACH(s, count) {
        const uint pair = segments[s].pair, first = segments[s].first;
        uint at = firsts[s];
        for (ulong casting = looks[s].casting; casting != 0u; casting &= casting - 1u) {
            GLOBAL const Watch* RESTRICT watch = watches + first + lowest_bit_of_long(casting);
            for (uint lanes = watch->cast; lanes != 0u; lanes &= lanes - 1u) {
                rays[at].pair = pair;
                rays[at].slot = VERTEX_LANES * watch->vertex_block + lowest_bit(lanes);
                ++at;
            }
        }
    }
}
// NOLINTEND(modernize-use-using)
