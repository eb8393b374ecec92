// SPDX-License-Identifier: Apache-2.0
// The certified method (docs/certified.md): a pair watches the vertex blocks near its target. Each is looked at only
// once the pair has moved as far as its nearest vertex was from touching.

#define AWAKE (-1.0f) // of Watch.wake: to be looked at in every step

typedef struct {
    int inside[VERTEX_LANES];      // the bounds, -1 or 0
    float safe[VERTEX_LANES];      // metres a vertex can move before it could be in contact; may be negative
    float x[VERTEX_LANES], y[VERTEX_LANES], z[VERTEX_LANES];
} WatchLanes;

// A vertex outside a closed mesh cannot be in contact before it has moved to the surface. Any other can only be in
// contact where the surface comes within its ray's reach.
DEVICE WatchLanes watch_lanes(GLOBAL const OrderedPair* RESTRICT pair, GLOBAL const VertexBlock* RESTRICT block,
                              GLOBAL const ShapeHeader* RESTRICT target, GLOBAL const uint* RESTRICT clearances) {
    WatchLanes found;
    float r[9], t[3], b[6], low[3], high[3];
    for (int i = 0; i < 9; ++i) r[i] = pair->rotation[i];
    for (int i = 0; i < 3; ++i) t[i] = pair->translation[i];
    for (int i = 0; i < 6; ++i) b[i] = pair->bounds[i];
    for (int i = 0; i < 3; ++i) low[i] = target->clearance_low[i];
    for (int i = 0; i < 3; ++i) high[i] = target->clearance_high[i];
    const float scale = target->clearance_scale, cell = target->clearance_cell, unit = target->clearance_unit;
    const uint size_x = target->clearance_size[0], size_y = target->clearance_size[1];
    const uint outward = target->outward;
    GLOBAL const uint* RESTRICT words = clearances + target->clearance_first;
    FOR_LANES(k, VERTEX_LANES) {
        const float vx = block->position[0][k], vy = block->position[1][k], vz = block->position[2][k];
        const float x = ((r[0] * vx + r[1] * vy) + r[2] * vz) + t[0];
        const float y = ((r[3] * vx + r[4] * vy) + r[5] * vz) + t[1];
        const float z = ((r[6] * vx + r[7] * vy) + r[8] * vz) + t[2];
        const uint inside = (x >= b[0]) & (x <= b[3]) & (y >= b[1]) & (y <= b[4]) & (z >= b[2]) & (z <= b[5]);
        // The nearest point of the box; empty lanes hold NaN and take its lower corner.
        const float up_x = x >= low[0] ? x : low[0], up_y = y >= low[1] ? y : low[1], up_z = z >= low[2] ? z : low[2];
        const float px = up_x <= high[0] ? up_x : high[0], py = up_y <= high[1] ? up_y : high[1];
        const float pz = up_z <= high[2] ? up_z : high[2];
        const float off_x = x - px, off_y = y - py, off_z = z - pz;
        const float off2 = (off_x * off_x + off_y * off_y) + off_z * off_z;
        const uint cx = (uint)(int)((px - low[0]) * scale);
        const uint cy = (uint)(int)((py - low[1]) * scale);
        const uint cz = (uint)(int)((pz - low[2]) * scale);
        const uint at = (cz * size_y + cy) * size_x + cx;
        const uint byte = (words[at >> 2] >> (8u * (at & 3u))) & 255u;
        const float ax = px - (low[0] + ((float)(int)cx + 0.5f) * cell);
        const float ay = py - (low[1] + ((float)(int)cy + 0.5f) * cell);
        const float az = pz - (low[2] + ((float)(int)cz + 0.5f) * cell);
        const float ball = (float)(int)(byte & (CLEARANCE_OUTSIDE - 1u)) * unit - root_of((ax * ax + ay * ay) + az * az);
        const float clear = ball > 0.0f ? ball : 0.0f;
        // The box is convex: what is behind the nearest point is no nearer than by Pythagoras.
        const float away = root_of(off2 + clear * clear);
        const uint outside = (outward & (uint)(off2 > 0.0f)) | ((uint)(ball > 0.0f) & (byte >> 7));
        const float reach = outside != 0u ? 0.0f : block->exit[k];
        found.inside[k] = -(int)inside;
        found.safe[k] = vx == vx ? away - reach : UNBOUNDED;
        found.x[k] = x;
        found.y[k] = y;
        found.z[k] = z;
    }
    return found;
}

DEVICE float least_of_sixteen(const float* values) {
    float least[8];
    FOR_LANES(k, 8) least[k] = values[k] < values[k + 8] ? values[k] : values[k + 8];
    for (int left = 4; left > 0; left /= 2)
        for (int k = 0; k < left; ++k) least[k] = least[k] < least[k + left] ? least[k] : least[k + left];
    return least[0];
}

// Every block that a new list holds is looked at in the step that made it.
KERNEL void begin_watches(RANGE uint count, GLOBAL const Cluster* RESTRICT clusters, GLOBAL const uint* RESTRICT firsts,
                          GLOBAL const uint* RESTRICT places, GLOBAL Watch* RESTRICT watches) {
    FOR_EACH(i, count) {
        const Cluster cluster = clusters[i];
        Watch watch;
        watch.vertex_block = cluster.vertex_block;
        watch.wake = AWAKE;
        watch.lanes = 0u;
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
        Look look;
        look.wake = UNBOUNDED;
        look.blocks = 0u;
        look.inside = 0u;
        uint ray_count = 0u;
        for (uint i = segment.first; i < segment.first + segment.count; ++i) {
            float own = watches[i].wake;
            if (own <= segment.clock) {
                WatchLanes found =
                    watch_lanes(pair, vertices + watches[i].vertex_block, target, clearances);
                int unsafe[VERTEX_LANES];
                FOR_LANES(k, VERTEX_LANES) unsafe[k] = -(int)!(found.safe[k] > segment.margin);
                const uint inside_mask = pack_sixteen(found.inside);
                uint lanes = inside_mask & pack_sixteen(unsafe);
                if (lanes != 0u && target->grid_size[0] != 0u) {
                    InsideLanes near;
                    FOR_LANES(k, VERTEX_LANES) {
                        near.inside[k] = found.inside[k];
                        near.x[k] = found.x[k];
                        near.y[k] = found.y[k];
                        near.z[k] = found.z[k];
                    }
                    lanes &= ~outside_lanes(&near, target, outside_cells);
                }
                const float least = least_of_sixteen(found.safe) - segment.margin;
                // Never asleep, whichever way the clock was rounded.
                own = least > 0.0f ? segment.clock + least : AWAKE;
                watches[i].wake = own;
                watches[i].lanes = lanes;
                look.blocks += 1u;
                look.inside += bit_count(inside_mask);
                ray_count += bit_count(lanes);
            }
            if (own < look.wake) look.wake = own;
        }
        looks[s] = look;
        rays[s] = ray_count;
    }
}

// A block that casts a ray is awake, so that it was looked at in this step.
KERNEL void write_watch_rays(RANGE uint count, GLOBAL const Segment* RESTRICT segments,
                             GLOBAL const Watch* RESTRICT watches, GLOBAL const uint* RESTRICT firsts,
                             GLOBAL Ray* RESTRICT rays) {
    FOR_EACH(s, count) {
        const Segment segment = segments[s];
        uint at = firsts[s];
        for (uint i = segment.first; i < segment.first + segment.count; ++i) {
            uint lanes = watches[i].wake == AWAKE ? watches[i].lanes : 0u;
            while (lanes != 0u) {
                Ray ray;
                ray.pair = segment.pair;
                ray.slot = VERTEX_LANES * watches[i].vertex_block + lowest_bit(lanes);
                rays[at] = ray;
                ++at;
                lanes &= lanes - 1u;
            }
        }
    }
}
