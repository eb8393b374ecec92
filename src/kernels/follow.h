// SPDX-License-Identifier: Apache-2.0
// Rays followed from step to step: a walk over neighbouring triangles from the one met last (LGA13; paper section 3),
// and predictive rays against the direction of the ray, for vertices about to touch (paper section 3.1, Algorithm 1).

// Where a ray begins that is not followed: in full, or only ahead, since its vertex is known not to be in contact.
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

// The face that the vertex will meet from inside if it goes on: the closest one ahead, not farther than `culling`
// (paper equation 1), where the ray is cut (paper section 5.3).
DEVICE uint predicted(const Closest* ahead, float culling) {
    return ahead->back <= culling && ahead->back <= ahead->front ? ahead->back_triangle : NONE;
}

// By the basic caster, the ray in full, and where it is no contact what lies ahead (culling below 0: nothing). `own`:
// whether the vertex may be in contact at all.
DEVICE Outcome cast_basic(const SourceRay* ray, uint own, const uint predictive, float culling,
                          READS(ShapeHeader) shape, READS(Node) nodes, READS(TriangleBlock) blocks,
                          READS(Packed3) normals) {
    const RayFrame frame = frame_ray(ray->position, ray->direction);
    Closest closest = nothing_hit(ray->reach, shape->tolerance), ahead = nothing_hit(culling, shape->tolerance);
    if (predictive != 0u && culling >= 0.0f) {
        const RayFrame opposite = frame_opposite(ray->position, ray->direction);
        traverse_basic_line(&closest, &frame, &ahead, &opposite, shape, blocks);
    } else if (own != 0u) {
        traverse_basic(&closest, &frame, 1u, shape, blocks);
    }
    Outcome end;
    end.hit = own != 0u ? decide(CASTER_BASIC, ray, &closest, shape, nodes, blocks, normals) : no_contact();
    end.next = end.hit.triangle != NONE ? end.hit.triangle : predicted(&ahead, culling);
    end.how = CAST;
    return end;
}

// One step of a walk: where the ray's line passes, as seen from one triangle.
STRUCT(Passage) {
    uint through; // the line passes through it, from inside out as the ray goes
    uint across;  // else the edge beyond which it passes, farthest first; NONE: none
    float t;
};

DEVICE Passage pass_triangle(const RayFrame* ray, READS(TriangleBlock) block, uint lane, uint came_by) {
    float x[3], y[3], z[3], edge[3], beyond[3];
    for (int c = 0; c < 3; ++c) {
        z[c] = block->corner[3 * c + ray->axis[2]][lane] - ray->origin[2];
        x[c] = (block->corner[3 * c + ray->axis[0]][lane] - ray->origin[0]) - ray->shear[0] * z[c];
        y[c] = (block->corner[3 * c + ray->axis[1]][lane] - ray->origin[1]) - ray->shear[1] * z[c];
    }
    // edge[e] belongs to the edge from corner e to the next.
    edge[1] = cross_accurate(x[2], y[1], y[2], x[1]);
    edge[2] = cross_accurate(x[0], y[2], y[0], x[2]);
    edge[0] = cross_accurate(x[1], y[0], y[1], x[0]);
    const float area = (edge[1] + edge[2]) + edge[0];
    Passage passage;
    passage.through =
        (uint)(edge[0] <= 0.0f) & (uint)(edge[1] <= 0.0f) & (uint)(edge[2] <= 0.0f) & (uint)(area != 0.0f);
    passage.across = NONE;
    passage.t = ((edge[1] * z[0] + edge[2] * z[1] + edge[0] * z[2]) / area) * ray->shear[2];
    if (passage.through == 0u) {
        float farthest = 0.0f;
        for (uint e = 0u; e < 3u; ++e) {
            const uint f = e == 2u ? 0u : e + 1u;
            const float ex = x[f] - x[e], ey = y[f] - y[e];
            const float length2 = ex * ex + ey * ey;
            const float off = area > 0.0f ? -edge[e] : edge[e];
            // Squared distance of the line from the edge; the way back is no way on.
            beyond[e] = off > 0.0f && length2 > 0.0f ? off * (off / length2) : 0.0f;
            if (e != came_by && beyond[e] > farthest) {
                farthest = beyond[e];
                passage.across = e;
            }
        }
    }
    return passage;
}

// Algorithm 1: from the last triangle over neighbours, across the edge that the line passes farthest beyond, until the
// line passes through one that it leaves through. Ends after max_iterations, at a border, and where it would turn back.
DEVICE Outcome walk(const SourceRay* ray, uint inside, uint triangle, uint max_iterations, const uint predictive,
                    float culling, READS(ShapeHeader) shape, READS(Face) faces, READS(TriangleBlock) blocks,
                    READS(Packed3) normals) {
    Outcome end;
    end.hit = no_contact();
    end.next = NONE;
    end.how = WALKED | LOST;
    const RayFrame frame = frame_ray(ray->position, ray->direction);
    uint at = triangle, came_from = NONE;
    for (uint i = 0u; i < max_iterations; ++i) {
        const Face face = faces[shape->face_first + at];
        if (face.slot == NONE) return end;
        uint came_by = NONE;
        for (uint e = 0u; e < 3u; ++e)
            if (came_from != NONE && face.neighbour[e] == came_from) came_by = e;
        READS(TriangleBlock) block = blocks + shape->triangle_block_first + face.slot / TRIANGLE_LANES;
        const Passage passage = pass_triangle(&frame, block, face.slot % TRIANGLE_LANES, came_by);
        if (passage.through != 0u) {
            const Packed3 n = normals[shape->normal_first + at];
            const float facing = (ray->direction[0] * n.x + ray->direction[1] * n.y) + ray->direction[2] * n.z;
            end.how = WALKED;
            if (passage.t >= 0.0f && passage.t <= ray->reach && inside != 0u) {
                end.hit.triangle = at;
                end.hit.distance = passage.t;
                end.hit.facing = facing;
                end.next = at;
            } else if (predictive != 0u && passage.t >= -culling) {
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

// What a walk says of a ray. CAST: nothing yet, it is to be cast in full.
DEVICE Outcome follow_ray(const SourceRay* ray, uint inside, uint start, uint max_iterations, const uint predictive,
                          const uint cast_lost, float culling, READS(ShapeHeader) shape, READS(Face) faces,
                          READS(TriangleBlock) blocks, READS(Packed3) normals) {
    Outcome end;
    end.hit = no_contact();
    end.next = NONE;
    end.how = CAST;
    if (start < AHEAD_ONLY) {
        end = walk(ray, inside, start, max_iterations, predictive, culling, shape, faces, blocks, normals);
        if ((end.how & LOST) != 0u && cast_lost != 0u) end.how |= CAST;
    }
    return end;
}

// The vertices of a full look that could be in contact, or are nearer than the culling distance. `wide`: the pairs with
// the bounds of the look; by pair, `reach`: that distance, `margins`: below which a vertex could be in contact. The
// upper half of PairBlock.lanes tells those whose own ray must be cast. counts: as of count_rays().
KERNEL void count_near_rays(COUNT(count), uint stride, READS(OrderedPair) wide, READS(float) reach,
                            READS(float) margins, READS(ShapeHeader) shapes, READS(VertexBlock) vertices,
                            READS(uint) clearances, WRITES(PairBlock) near_blocks, WRITES(uint) counts) {
    FOR_EACH(i, count) {
        READS(OrderedPair) pair = wide + near_blocks[i].pair;
        READS(ShapeHeader) target = shapes + pair->target;
        const float near = reach[near_blocks[i].pair], margin = margins[near_blocks[i].pair];
        READS(VertexBlock) block = vertices + near_blocks[i].vertex_block;
        const InsideLanes held = inside_lanes(pair, block);
        const SafeLanes found = safe_lanes(&held, pair, block, target, clearances);
        int close[VERTEX_LANES], unsafe[VERTEX_LANES];
        FOR_LANES(k, VERTEX_LANES) {
            close[k] = -(int)!(found.safe[k] > near);
            unsafe[k] = -(int)!(found.safe[k] > margin);
        }
        const uint inside_mask = pack_sixteen(held.inside);
        const uint lanes = inside_mask & pack_sixteen(close);
        near_blocks[i].lanes = lanes | ((lanes & pack_sixteen(unsafe)) << VERTEX_LANES);
        counts[i] = bit_count(lanes);
        counts[stride + i] = bit_count(inside_mask);
    }
}

KERNEL void write_near_rays(COUNT(count), READS(PairBlock) near_blocks, READS(uint) firsts, WRITES(Ray) rays,
                            WRITES(uint) starts) {
    FOR_EACH(i, count) {
        const PairBlock found = near_blocks[i];
        uint lanes = found.lanes & 0xffffu;
        uint at = firsts[i];
        while (lanes != 0u) {
            const uint lane = lowest_bit(lanes);
            Ray ray;
            ray.pair = found.pair;
            ray.slot = VERTEX_LANES * found.vertex_block + lane;
            rays[at] = ray;
            starts[at] = ((found.lanes >> (VERTEX_LANES + lane)) & 1u) != 0u ? IN_FULL : AHEAD_ONLY;
            ++at;
            lanes &= lanes - 1u;
        }
    }
}

// Candidates of the last step become rays of this one. Segment.first: of the candidates; firsts[s]: of the rays.
KERNEL void copy_candidates(COUNT(count), READS(Segment) segments, READS(uint) firsts, READS(Candidate) candidates,
                            WRITES(Ray) rays, WRITES(uint) starts) {
    FOR_EACH(s, count) {
        const Segment segment = segments[s];
        for (uint i = 0u; i < segment.count; ++i) {
            const Candidate candidate = candidates[segment.first + i];
            Ray ray;
            ray.pair = segment.pair;
            ray.slot = candidate.slot;
            rays[firsts[s] + i] = ray;
            starts[firsts[s] + i] = candidate.triangle;
        }
    }
}

// Predictive rays of vertices that are not in contact; nexts: see Outcome.
DEVICE_BATCH void cast_ahead(Group* ahead, READS(ShapeHeader) shapes, READS(Node) nodes, READS(TriangleBlock) blocks,
                             WRITES(uint) nexts) {
    Closest met[RAYS_IN_GROUP];
    find_group(met, ahead, true, shapes, nodes, blocks);
    for (uint r = 0u; r < ahead->count; ++r) nexts[ahead->at[r]] = predicted(met + r, ahead->reach[r]);
    ahead->count = 0u;
}

// Where such a ray is no contact, what lies ahead is cast next.
DEVICE_BATCH void cast_in_full(Group* casting, Group* ahead, uint predictive, READS(float) cullings,
                               READS(ShapeHeader) shapes, READS(Node) nodes, READS(TriangleBlock) blocks,
                               READS(Packed3) normals, uint stride, WRITES(Hit) hits, WRITES(uint) outcomes,
                               WRITES(uint) nexts) {
    Closest met[RAYS_IN_GROUP];
    cast_group(met, casting, shapes, nodes, blocks, normals, stride, hits, outcomes);
    for (uint r = 0u; r < casting->count; ++r) {
        const uint at = casting->at[r], pair = casting->pair[r];
        nexts[at] = hits[at].triangle;
        if (predictive == 0u || nexts[at] != NONE || cullings[pair] < 0.0f) continue;
        const SourceRay source = ray_of(casting, r);
        add_ray(ahead, at, &source, cullings[pair], pair, casting->target[r], shapes);
        if (is_full(ahead)) cast_ahead(ahead, shapes, nodes, blocks, nexts);
    }
    casting->count = 0u;
}

// hows and nexts: see Outcome.
KERNEL void follow_rays_bvh(COUNT(count), uint max_iterations, uint predictive, uint cast_lost, uint stride,
                            READS(OrderedPair) pairs, READS(float) cullings, READS(ShapeHeader) shapes,
                            READS(VertexBlock) vertices, READS(Node) nodes, READS(TriangleBlock) blocks,
                            READS(Face) faces, READS(Packed3) normals, READS(Ray) rays, READS(uint) starts,
                            WRITES(Hit) hits, WRITES(uint) outcomes, WRITES(uint) nexts, WRITES(uint) hows) {
    Group casting, ahead;
    clear_group(&casting);
    clear_group(&ahead);
    FOR_EACH(i, count) {
        const Ray ray = rays[i];
        const uint target = pairs[ray.pair].target;
        const float culling = cullings[ray.pair];
        READS(ShapeHeader) shape = shapes + target;
        const SourceRay source = source_ray(pairs + ray.pair, vertices, ray.slot);
        const uint inside = (uint)in_bounds(pairs + ray.pair, source.position);
        const Outcome end = follow_ray(&source, inside, starts[i], max_iterations, predictive, cast_lost, culling,
                                       shape, faces, blocks, normals);
        record_hit(end.hit, (uint)((end.how & CAST) != 0u), i, stride, hits, outcomes);
        nexts[i] = end.next;
        hows[i] = end.how;
        if ((end.how & CAST) == 0u) continue;
        if (inside != 0u && starts[i] != AHEAD_ONLY) {
            add_ray(&casting, i, &source, source.reach, ray.pair, target, shapes);
            if (is_full(&casting))
                cast_in_full(&casting, &ahead, predictive, cullings, shapes, nodes, blocks, normals, stride, hits,
                             outcomes, nexts);
        } else if (predictive != 0u && end.next == NONE && culling >= 0.0f) {
            add_ray(&ahead, i, &source, culling, ray.pair, target, shapes);
            if (is_full(&ahead)) cast_ahead(&ahead, shapes, nodes, blocks, nexts);
        }
    }
    if (RAYS_IN_GROUP > 1) {
        cast_in_full(&casting, &ahead, predictive, cullings, shapes, nodes, blocks, normals, stride, hits, outcomes,
                     nexts);
        cast_ahead(&ahead, shapes, nodes, blocks, nexts);
    }
}

KERNEL void follow_rays_basic(COUNT(count), uint max_iterations, uint predictive, uint cast_lost, uint stride,
                              READS(OrderedPair) pairs, READS(float) cullings, READS(ShapeHeader) shapes,
                              READS(VertexBlock) vertices, READS(Node) nodes, READS(TriangleBlock) blocks,
                              READS(Face) faces, READS(Packed3) normals, READS(Ray) rays, READS(uint) starts,
                              WRITES(Hit) hits, WRITES(uint) outcomes, WRITES(uint) nexts, WRITES(uint) hows) {
    FOR_EACH(i, count) {
        READS(OrderedPair) pair = pairs + rays[i].pair;
        READS(ShapeHeader) shape = shapes + pair->target;
        const float culling = cullings[rays[i].pair];
        const SourceRay ray = source_ray(pair, vertices, rays[i].slot);
        const uint inside = (uint)in_bounds(pair, ray.position);
        Outcome end = follow_ray(&ray, inside, starts[i], max_iterations, predictive, cast_lost, culling, shape, faces,
                                 blocks, normals);
        if ((end.how & CAST) != 0u) {
            const uint how = end.how;
            end = cast_basic(&ray, starts[i] != AHEAD_ONLY ? inside : 0u, predictive, culling, shape, nodes, blocks,
                             normals);
            end.how |= how;
        }
        record_hit(end.hit, (uint)((end.how & CAST) != 0u), i, stride, hits, outcomes);
        nexts[i] = end.next;
        hows[i] = end.how;
    }
}

// Rays of a pair lie together. ranges: first and end of each pair, zero where it has none.
KERNEL void find_ranges(COUNT(count), READS(Ray) rays, WRITES(uint) ranges) {
    FOR_EACH(i, count) {
        const uint pair = rays[i].pair;
        if (i == 0u || rays[i - 1u].pair != pair) ranges[2u * pair] = i;
        if (i + 1u == ALL(count) || rays[i + 1u].pair != pair) ranges[2u * pair + 1u] = i + 1u;
    }
}

KERNEL void count_candidates(COUNT(count), READS(uint) ranges, READS(Hit) hits, READS(uint) nexts, READS(uint) hows,
                             WRITES(Followed) followed, WRITES(uint) counts) {
    FOR_EACH(p, count) {
        Followed sum;
        sum.kept = 0u;
        sum.predictions = 0u;
        sum.walks = 0u;
        sum.lost = 0u;
        sum.cast = 0u;
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

KERNEL void write_candidates(COUNT(count), READS(uint) ranges, READS(Ray) rays, READS(uint) nexts, READS(uint) firsts,
                             WRITES(Candidate) candidates) {
    FOR_EACH(p, count) {
        uint at = firsts[p];
        for (uint i = ranges[2u * p]; i < ranges[2u * p + 1u]; ++i) {
            if (nexts[i] != NONE) {
                Candidate candidate;
                candidate.slot = rays[i].slot;
                candidate.triangle = nexts[i];
                candidates[at] = candidate;
                ++at;
            }
        }
    }
}
