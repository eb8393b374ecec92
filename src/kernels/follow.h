// SPDX-License-Identifier: Apache-2.0
// Rays followed from step to step: a walk over neighbouring triangles from the one met last (LGA13; paper section 3),
// and predictive rays against the direction of the ray, for vertices about to touch (paper section 3.1, Algorithm 1).

// Start values of rays that are not followed: cast in full, or only ahead (the vertex is known not to be in contact).
#define IN_FULL NONE
#define AHEAD_ONLY 0xfffffffeu

// How a ray ended: bits of Outcome.how.
#define WALKED 1u
#define LOST 2u
#define CAST 4u

STRUCT(Outcome) {
    Hit hit;
    uint next; // triangle to begin at in the next step, NONE: not followed
    uint how;
};

// The arguments of a kernel that follows rays.
STRUCT(Follow) {
    RayArrays all;
    READS(DirectedPair) pairs;
    READS(float) cullings; // by pair, metres; below 0: no predictive rays
    READS(Ray) rays;
    READS(uint) starts;
    WRITES(uint) nexts; // this and hows: see Outcome
    WRITES(uint) hows;
    uint max_iterations, predictive, cast_lost;
};

STRUCT(FollowedRay) {
    SourceRay own;
    uint pair, start;
    READS(ShapeHeader) shape; // the target's
    uint inside;              // the bounds, and not AHEAD_ONLY: it may be in contact
    float culling;
};

DEVICE FollowedRay followed_ray(const Follow* follow, uint i) {
    const Ray ray = follow->rays[i];
    READS(DirectedPair) pair = follow->pairs + ray.pair;
    FollowedRay followed;
    followed.own = source_ray(pair, follow->all.shapes, follow->all.memory, ray.vertex_lane);
    followed.pair = ray.pair;
    followed.shape = follow->all.shapes + pair->target;
    followed.start = follow->starts[i];
    followed.inside = (uint)in_bounds(pair, followed.own.position) & (uint)(followed.start != AHEAD_ONLY);
    followed.culling = follow->cullings[ray.pair];
    return followed;
}

DEVICE void record_outcome(const Follow* follow, uint i, const Outcome end) {
    record_hit(&follow->all, i, end.hit, (uint)((end.how & CAST) != 0u));
    follow->nexts[i] = end.next;
    follow->hows[i] = end.how;
}

// The face through which the vertex will enter if it moves on: the closest one ahead, not farther than `culling` (paper
// equation 1), where the ray ends (paper section 5.3).
DEVICE uint predicted(const Closest* ahead, float culling) {
    return ahead->back <= culling && ahead->back <= ahead->front ? ahead->back_triangle : NONE;
}

// Casts the ray in full with the basic caster and, if it is no contact, predicts the face ahead.
DEVICE Outcome cast_basic(const Follow* follow, const FollowedRay* followed) {
    const SourceRay* ray = &followed->own;
    READS(ShapeHeader) shape = followed->shape;
    const RayFrame frame = frame_ray(ray->position, ray->direction, false);
    Closest closest = nothing_hit(ray->reach, shape->tolerance);
    Closest ahead = nothing_hit(followed->culling, shape->tolerance);
    if (follow->predictive != 0u && followed->culling >= 0.0f) {
        const RayFrame opposite = frame_ray(ray->position, ray->direction, true);
        traverse_basic_line(&closest, &frame, &ahead, &opposite, shape, follow->all.memory);
    } else if (followed->inside != 0u) {
        traverse_basic(&closest, &frame, 1u, shape, follow->all.memory);
    }
    const Hit hit = followed->inside != 0u ? decide(&follow->all, CASTER_BASIC, ray, &closest, shape) : no_contact(0u);
    const Outcome end = {hit, hit.triangle != NONE ? hit.triangle : predicted(&ahead, followed->culling), CAST};
    return end;
}

// One step of a walk: where the ray's line passes one triangle.
STRUCT(Passage) {
    uint through; // the line passes through it, from inside out as the ray goes
    uint across;  // else the edge that it passes farthest beyond; NONE: none
    float t;
};

DEVICE Passage pass_triangle(const RayFrame* ray, READS(TriangleBlock) block, uint lane, uint came_by) {
    const Corners at = corners_of(ray, block, lane);
    const Edges edges = edges_of(at.x[0], at.y[0], at.x[1], at.y[1], at.x[2], at.y[2]);
    const float edge[3] = {edges.w, edges.u, edges.v}, area = area_of(edges); // from each corner to the next
    Passage passage;
    passage.through =
        (uint)(edges.u <= 0.0f) & (uint)(edges.v <= 0.0f) & (uint)(edges.w <= 0.0f) & (uint)(area != 0.0f);
    passage.across = NONE;
    passage.t = distance_of(edges, at.z[0], at.z[1], at.z[2], ray->shear[2]);
    float farthest = 0.0f;
    for (uint e = 0u; e < 3u && passage.through == 0u; ++e) {
        const uint f = e == 2u ? 0u : e + 1u;
        const float ex = at.x[f] - at.x[e], ey = at.y[f] - at.y[e];
        const float length2 = ex * ex + ey * ey;
        const float off = area > 0.0f ? -edge[e] : edge[e];
        // Squared distance of the line from the edge. The walk must not turn back.
        const float beyond = off > 0.0f && length2 > 0.0f ? off * (off / length2) : 0.0f;
        if (e != came_by && beyond > farthest) {
            farthest = beyond;
            passage.across = e;
        }
    }
    return passage;
}

// Algorithm 1: walks from the last triangle over neighbours, across the edge that the line passes farthest beyond,
// until the line leaves through a triangle. Ends after max_iterations, at a border, and where it would turn back. CAST:
// the ray must be cast in full, since no walk begins or, with cast_lost, since the walk is lost.
DEVICE Outcome follow_ray(const Follow* follow, const FollowedRay* followed) {
    const SourceRay* ray = &followed->own;
    READS(ShapeHeader) shape = followed->shape;
    READS(TriangleBlock) blocks = AT(follow->all.memory, TriangleBlock, shape->triangle_blocks);
    READS(Face) faces = AT(follow->all.memory, Face, shape->faces);
    Outcome end = {no_contact(0u), NONE, CAST};
    if (followed->start >= AHEAD_ONLY) return end;
    end.how = WALKED | LOST | (follow->cast_lost != 0u ? CAST : 0u);
    const RayFrame frame = frame_ray(ray->position, ray->direction, false);
    uint at = followed->start, came_from = NONE;
    for (uint i = 0u; i < follow->max_iterations; ++i) {
        const Face face = faces[at];
        if (face.triangle_lane == NONE) return end;
        uint came_by = NONE;
        for (uint e = 0u; e < 3u; ++e)
            if (came_from != NONE && face.neighbour[e] == came_from) came_by = e;
        const Passage passage = pass_triangle(&frame, blocks + face.triangle_lane / TRIANGLE_LANES,
                                              face.triangle_lane % TRIANGLE_LANES, came_by);
        if (passage.through != 0u) {
            end.how = WALKED;
            if (passage.t >= 0.0f && passage.t <= ray->reach && followed->inside != 0u) {
                end.hit = hit_of(&follow->all, ray, shape, at, passage.t, 0u);
                end.next = at;
            } else if (follow->predictive != 0u && passage.t >= -followed->culling) {
                end.next = at;
            }
            return end;
        }
        if (passage.across == NONE) return end;
        came_from = at;
        at = face.neighbour[passage.across];
        if (at == NONE) return end;
    }
    return end;
}

// The vertices of a full test that could be in contact, or are nearer than the culling distance. `wide`: the pairs with
// the bounds of the test. By pair: `reach`: that distance; `margins`: with at most this safe distance a vertex could be
// in contact. The upper half of PairBlock.lanes marks vertices whose own ray must be cast. counts: see count_rays().
KERNEL void count_near_rays(COUNT(count), uint stride, READS(DirectedPair) wide, READS(float) reach,
                            READS(float) margins, READS(ShapeHeader) shapes, READS(ulong) memory,
                            WRITES(PairBlock) near_blocks, WRITES(uint) counts) {
    FOR_EACH_VERTICES(i, first, count) {
        READS(DirectedPair) pair = wide + near_blocks[i].pair;
        READS(ShapeHeader) target = shapes + pair->target;
        const float near = reach[near_blocks[i].pair], margin = margins[near_blocks[i].pair];
        READS(VertexBlock) block = source_block(pair, shapes, memory, near_blocks[i].vertex_block);
        const InsideLanes held = inside_lanes(pair, block, first);
        float safe[VERTICES_AT_ONCE];
        safe_lanes(safe, &held, pair, block, first, target, memory);
        int close[VERTICES_AT_ONCE], unsafe[VERTICES_AT_ONCE];
        FOR_LANES(k, VERTICES_AT_ONCE) {
            close[k] = -(int)!(safe[k] > near);
            unsafe[k] = -(int)!(safe[k] > margin);
        }
        const uint inside_mask = pack_vertices(held.inside);
        const uint lanes = inside_mask & pack_vertices(close);
        ADD_TO(&near_blocks[i].lanes, (lanes | ((lanes & pack_vertices(unsafe)) << VERTEX_LANES)) << first);
        ADD_TO(counts + i, bit_count(lanes));
        ADD_TO(counts + stride + i, bit_count(inside_mask));
    }
}

KERNEL void write_near_rays(COUNT(count), READS(PairBlock) near_blocks, READS(uint) firsts, WRITES(Ray) rays,
                            WRITES(uint) starts) {
    FOR_EACH_VERTICES(i, first, count) {
        const PairBlock found = near_blocks[i];
        uint at = firsts[i] + bit_count(found.lanes & ((1u << first) - 1u));
        for (uint lanes = own_lanes(found.lanes & 0xffffu, first); lanes != 0u; lanes &= lanes - 1u) {
            const uint lane = lowest_bit(lanes);
            rays[at].pair = found.pair;
            rays[at].vertex_lane = VERTEX_LANES * found.vertex_block + lane;
            starts[at] = ((found.lanes >> (VERTEX_LANES + lane)) & 1u) != 0u ? IN_FULL : AHEAD_ONLY;
            ++at;
        }
    }
}

// Cached rays of the last step become rays of this one. Segment.first: of the cached rays; firsts[s]: of the rays.
KERNEL void copy_cached_rays(COUNT(count), READS(Segment) segments, READS(uint) firsts, READS(CachedRay) cached,
                             WRITES(Ray) rays, WRITES(uint) starts) {
    FOR_EACH(s, count) {
        const Segment segment = segments[s];
        for (uint i = 0u; i < segment.count; ++i) {
            const uint at = firsts[s] + i;
            const CachedRay ray = cached[segment.first + i];
            rays[at].pair = segment.pair;
            rays[at].vertex_lane = ray.vertex_lane;
            starts[at] = ray.triangle;
        }
    }
}

// Casts predictive rays of vertices that are not in contact.
DEVICE_BATCH void cast_ahead(const Follow* follow, RayGroup* ahead) {
    Closest met[RAYS_IN_GROUP];
    find_group(&follow->all, met, ahead, true);
    for (uint r = 0u; r < ahead->count; ++r) follow->nexts[ahead->at[r]] = predicted(met + r, ahead->reach[r]);
    ahead->count = 0u;
}

// Casts rays in full. If one is no contact, its predictive ray is cast next.
DEVICE_BATCH void cast_group_in_full(const Follow* follow, RayGroup* casting, RayGroup* ahead) {
    Closest met[RAYS_IN_GROUP];
    cast_group(&follow->all, met, casting);
    for (uint r = 0u; r < casting->count; ++r) {
        const uint at = casting->at[r], pair = casting->pair[r];
        const float culling = follow->cullings[pair];
        follow->nexts[at] = follow->all.hits[at].triangle;
        if (follow->predictive == 0u || follow->nexts[at] != NONE || culling < 0.0f) continue;
        const SourceRay source = ray_of(casting, r);
        add_ray(ahead, at, &source, culling, pair, casting->shape[r]);
        if (is_full(ahead)) cast_ahead(follow, ahead);
    }
    casting->count = 0u;
}

KERNEL void follow_rays_bvh(COUNT(count), uint max_iterations, uint predictive, uint cast_lost, uint stride,
                            READS(DirectedPair) pairs, READS(float) cullings, READS(ShapeHeader) shapes,
                            READS(ulong) memory, READS(Ray) rays, READS(uint) starts, WRITES(Hit) hits,
                            WRITES(uint) outcomes, WRITES(uint) nexts, WRITES(uint) hows) {
    const Follow follow = {{shapes, memory, stride, hits, outcomes},
                           pairs,
                           cullings,
                           rays,
                           starts,
                           nexts,
                           hows,
                           max_iterations,
                           predictive,
                           cast_lost};
    RayGroup casting, ahead;
    clear_group(&casting);
    clear_group(&ahead);
    FOR_EACH(i, count) {
        const FollowedRay ray = followed_ray(&follow, i);
        const Outcome end = follow_ray(&follow, &ray);
        record_outcome(&follow, i, end);
        if ((end.how & CAST) == 0u) continue;
        if (ray.inside != 0u) {
            add_ray(&casting, i, &ray.own, ray.own.reach, ray.pair, ray.shape);
            if (is_full(&casting)) cast_group_in_full(&follow, &casting, &ahead);
        } else if (predictive != 0u && end.next == NONE && ray.culling >= 0.0f) {
            add_ray(&ahead, i, &ray.own, ray.culling, ray.pair, ray.shape);
            if (is_full(&ahead)) cast_ahead(&follow, &ahead);
        }
    }
    if (RAYS_IN_GROUP > 1) {
        cast_group_in_full(&follow, &casting, &ahead);
        cast_ahead(&follow, &ahead);
    }
}

KERNEL void follow_rays_basic(COUNT(count), uint max_iterations, uint predictive, uint cast_lost, uint stride,
                              READS(DirectedPair) pairs, READS(float) cullings, READS(ShapeHeader) shapes,
                              READS(ulong) memory, READS(Ray) rays, READS(uint) starts, WRITES(Hit) hits,
                              WRITES(uint) outcomes, WRITES(uint) nexts, WRITES(uint) hows) {
    const Follow follow = {{shapes, memory, stride, hits, outcomes},
                           pairs,
                           cullings,
                           rays,
                           starts,
                           nexts,
                           hows,
                           max_iterations,
                           predictive,
                           cast_lost};
    FOR_EACH(i, count) {
        const FollowedRay ray = followed_ray(&follow, i);
        Outcome end = follow_ray(&follow, &ray);
        if ((end.how & CAST) != 0u) {
            const uint how = end.how;
            end = cast_basic(&follow, &ray);
            end.how |= how;
        }
        record_outcome(&follow, i, end);
    }
}

// The rays of a pair are contiguous. ranges: first and end of each pair, zero if it has none.
KERNEL void find_ranges(COUNT(count), READS(Ray) rays, WRITES(uint) ranges) {
    FOR_EACH(i, count) {
        const uint pair = rays[i].pair;
        if (i == 0u || rays[i - 1u].pair != pair) ranges[2u * pair] = i;
        if (i + 1u == ALL(count) || rays[i + 1u].pair != pair) ranges[2u * pair + 1u] = i + 1u;
    }
}

KERNEL void count_cached_rays(COUNT(count), READS(uint) ranges, READS(Hit) hits, READS(uint) nexts, READS(uint) hows,
                              WRITES(Followed) followed, WRITES(uint) counts) {
    FOR_EACH(p, count) {
        Followed sum = {0u, 0u, 0u, 0u, 0u};
        for (uint i = ranges[2u * p]; i < ranges[2u * p + 1u]; ++i) {
            const uint kept = (uint)(nexts[i] != NONE), how = hows[i];
            sum.kept += kept;
            sum.predictions += kept & (uint)(hits[i].triangle == NONE);
            sum.walks += (uint)((how & WALKED) != 0u);
            sum.lost += (uint)((how & LOST) != 0u);
            sum.cast += (uint)((how & CAST) != 0u);
        }
        followed[p] = sum;
        counts[p] = sum.kept;
    }
}

KERNEL void write_cached_rays(COUNT(count), READS(uint) ranges, READS(Ray) rays, READS(uint) nexts, READS(uint) firsts,
                              WRITES(CachedRay) cached) {
    FOR_EACH(p, count) {
        uint at = firsts[p];
        for (uint i = ranges[2u * p]; i < ranges[2u * p + 1u]; ++i) {
            if (nexts[i] != NONE) {
                cached[at].vertex_lane = rays[i].vertex_lane;
                cached[at].triangle = nexts[i];
                ++at;
            }
        }
    }
}
