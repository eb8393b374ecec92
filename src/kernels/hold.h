// SPDX-License-Identifier: Apache-2.0
// Rays that need not be cast again (docs/certified.md): around a ray, up to a little behind what it met, lies a tube
// that no other triangle enters. Until a point of the ray has moved by its radius, that one triangle alone decides.
// NOLINTBEGIN(modernize-use-using): this text is C as well

#define WAIT_STEPS 3.0f     // before the next attempt, where a tube was hardly wide enough for one step
#define WORTH_HOLDING 0.02f // of the radius sought
#define LIMIT_TOLERANCES 4.0f

typedef struct {
    float origin[3];
    float along[3], u[3], v[3]; // unit vectors, square to each other
    float length;
    float box[6]; // around the tube: lower x y z, upper x y z
} Tube;

// The triangle nearest to the tube's axis, and how far the axis is from every other.
typedef struct {
    float least, second;
    uint slot; // TRIANGLE_LANES * block + lane
} Neighbours;

DEVICE Tube tube_of(const SourceRay* ray, float length, float radius) {
    Tube tube;
    const float* d = ray->direction;
    // Rotations are rigid to 1e-4 only: not quite of unit length, and distances count in lengths of it.
    const float size = root_of((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]);
    for (int i = 0; i < 3; ++i) {
        tube.origin[i] = ray->position[i];
        tube.along[i] = d[i] / size;
    }
    tube.length = length * size;
    const float ax = magnitude_of(tube.along[0]), ay = magnitude_of(tube.along[1]), az = magnitude_of(tube.along[2]);
    const int least = ax < ay ? (ax < az ? 0 : 2) : (ay < az ? 1 : 2);
    const int next = least == 2 ? 0 : least + 1, last = next == 2 ? 0 : next + 1;
    const float side = 1.0f / root_of(tube.along[next] * tube.along[next] + tube.along[last] * tube.along[last]);
    tube.u[least] = 0.0f;
    tube.u[next] = -(tube.along[last] * side);
    tube.u[last] = tube.along[next] * side;
    for (int i = 0; i < 3; ++i) {
        const int j = i == 2 ? 0 : i + 1, k = j == 2 ? 0 : j + 1;
        tube.v[i] = tube.along[j] * tube.u[k] - tube.along[k] * tube.u[j];
        const float end = tube.origin[i] + tube.length * tube.along[i];
        tube.box[i] = (tube.origin[i] < end ? tube.origin[i] : end) - radius;
        tube.box[3 + i] = (tube.origin[i] > end ? tube.origin[i] : end) + radius;
    }
    return tube;
}

// How far the origin is from a triangle of the plane along the normal of its edge from a to b; c is the third corner.
DEVICE float edge_gap(float au, float av, float bu, float bv, float cu, float cv) {
    const float nu = bv - av, nv = au - bu, n2 = nu * nu + nv * nv;
    const float scale = n2 > 1.0e-30f ? 0.9999f / root_of(n2) : 0.0f;
    const float edge = (nu * au + nv * av) * scale, third = (nu * cu + nv * cv) * scale;
    const float low = edge < third ? edge : third, high = edge > third ? edge : third;
    return low > -high ? low : -high;
}

// No triangle is nearer to the axis than along a direction that separates them: the axis, the triangle's normal, and,
// seen along the axis, the normals of its edges. Any direction will do, so that rounding one does no harm.
DEVICE void nearest_lanes(Neighbours* found, const Tube* tube, GLOBAL const TriangleBlock* RESTRICT block, uint index) {
    float apart[TRIANGLE_LANES];
    int nearer[TRIANGLE_LANES];
    const float ox = tube->origin[0], oy = tube->origin[1], oz = tube->origin[2];
    const float dx = tube->along[0], dy = tube->along[1], dz = tube->along[2];
    const float px = tube->u[0], py = tube->u[1], pz = tube->u[2];
    const float qx = tube->v[0], qy = tube->v[1], qz = tube->v[2];
    const float length = tube->length, bound = found->second;
    FOR_LANES(k, TRIANGLE_LANES) {
        const float ax = block->corner[0][k] - ox, ay = block->corner[1][k] - oy, az = block->corner[2][k] - oz;
        const float bx = block->corner[3][k] - ox, by = block->corner[4][k] - oy, bz = block->corner[5][k] - oz;
        const float cx = block->corner[6][k] - ox, cy = block->corner[7][k] - oy, cz = block->corner[8][k] - oz;
        const float as = (dx * ax + dy * ay) + dz * az, bs = (dx * bx + dy * by) + dz * bz;
        const float cs = (dx * cx + dy * cy) + dz * cz;
        const float au = (px * ax + py * ay) + pz * az, av = (qx * ax + qy * ay) + qz * az;
        const float bu = (px * bx + py * by) + pz * bz, bv = (qx * bx + qy * by) + qz * bz;
        const float cu = (px * cx + py * cy) + pz * cz, cv = (qx * cx + qy * cy) + qz * cz;
        const float first_ab = as < bs ? as : bs, last_ab = as > bs ? as : bs;
        const float first = first_ab < cs ? first_ab : cs, last = last_ab > cs ? last_ab : cs;
        const float beyond = first - length, behind = -last;
        float best = beyond > behind ? beyond : behind;
        const float gap_ab = edge_gap(au, av, bu, bv, cu, cv), gap_bc = edge_gap(bu, bv, cu, cv, au, av);
        const float gap_ca = edge_gap(cu, cv, au, av, bu, bv);
        best = gap_ab > best ? gap_ab : best;
        best = gap_bc > best ? gap_bc : best;
        best = gap_ca > best ? gap_ca : best;
        // The plane's normal, in the frame of the axis.
        const float pu = (bv - av) * (cs - as) - (bs - as) * (cv - av);
        const float pv = (bs - as) * (cu - au) - (bu - au) * (cs - as);
        const float ps = (bu - au) * (cv - av) - (bv - av) * (cu - au);
        const float n2 = (pu * pu + pv * pv) + ps * ps;
        const float scale = n2 > 1.0e-30f ? 0.9999f / root_of(n2) : 0.0f;
        const float ah = (pu * au + pv * av) + ps * as, bh = (pu * bu + pv * bv) + ps * bs;
        const float ch = (pu * cu + pv * cv) + ps * cs, end = ps * length;
        const float low_ab = ah < bh ? ah : bh, high_ab = ah > bh ? ah : bh;
        const float low = low_ab < ch ? low_ab : ch, high = high_ab > ch ? high_ab : ch;
        const float above = low - (end > 0.0f ? end : 0.0f), below = (end < 0.0f ? end : 0.0f) - high;
        const float gap = (above > below ? above : below) * scale;
        best = gap > best ? gap : best;
        apart[k] = best;
        nearer[k] = -(int)(best < bound); // not NaN, of empty lanes
    }
    for (uint left = pack_sixteen(nearer); left != 0u; left &= left - 1u) {
        const uint lane = lowest_bit(left);
        if (apart[lane] < found->least) {
            found->second = found->least;
            found->least = apart[lane];
            found->slot = TRIANGLE_LANES * index + lane;
        } else if (apart[lane] < found->second) {
            found->second = apart[lane];
        }
    }
}

// Of all triangles within `radius` of the tube's axis.
DEVICE_CALL Neighbours search_tube(const Tube* tube, float radius, GLOBAL const ShapeHeader* RESTRICT shape,
                                   GLOBAL const Node* RESTRICT nodes, GLOBAL const TriangleBlock* RESTRICT blocks) {
    Neighbours found;
    found.least = radius;
    found.second = radius;
    found.slot = NONE;
    GLOBAL const Node* RESTRICT tree = nodes + shape->node_first;
    ulong trail = 0u;
    uint at = 0u;
    uint children = children_in(tube->box, tree);
    for (;;) {
        while (children != 0u) {
            const uint lane = lowest_bit(children);
            const uint child = tree[at].child[lane];
            children &= children - 1u;
            if ((child & LEAF) != 0u) {
                const uint index = child & ~LEAF;
                nearest_lanes(&found, tube, blocks + shape->triangle_block_first + index, index);
            } else {
                trail = (trail << NODE_LANES) | (ulong)children;
                at = child;
                children = children_in(tube->box, tree + at);
            }
        }
        if (at == 0u) return found;
        at = tree[at].parent;
        children = (uint)(trail & 0xffffu);
        trail >>= NODE_LANES;
    }
}

// The place of a ray among those that its pair held, which ascend by slot; their number if it is not there. likely: its
// place among those of this step, mostly the same.
DEVICE uint find_held(GLOBAL const Held* RESTRICT held, uint count, uint slot, uint likely) {
    if (likely < count && held[likely].slot == slot) return likely;
    uint low = 0u, high = count;
    while (low < high) {
        const uint middle = (low + high) / 2u;
        if (held[middle].slot < slot)
            low = middle + 1u;
        else
            high = middle;
    }
    return low < count && held[low].slot == slot ? low : count;
}

DEVICE Held nothing_held(uint slot) {
    Held held;
    held.slot = slot;
    held.triangle = NONE;
    held.safe = 0.0f;
    held.limit = 0.0f;
    for (int i = 0; i < 3; ++i) held.position[i] = held.direction[i] = 0.0f;
    return held;
}

// Nothing is known of the pair's rays, and nothing is to be sought: nobody will ask in the next step.
DEVICE bool is_idle(GLOBAL const Holder* RESTRICT holder) {
    return holder->count == 0u && holder->radius <= 0.0f;
}

DEVICE Held held_before(GLOBAL const Holder* RESTRICT holder, GLOBAL const Held* RESTRICT before, uint slot, uint ray) {
    const uint at = find_held(before + holder->first, holder->count, slot, ray - holder->now_first);
    return at < holder->count ? before[holder->first + at] : nothing_held(slot);
}

// How far a point of the ray, up to its limit, has moved at most: as far as either end.
DEVICE float moved_by(const Held* held, const SourceRay* ray) {
    float start = 0.0f, end = 0.0f;
    for (int i = 0; i < 3; ++i) {
        const float shift = ray->position[i] - held->position[i];
        const float far = shift + held->limit * (ray->direction[i] - held->direction[i]);
        start += shift * shift;
        end += far * far;
    }
    return root_of(start > end ? start : end);
}

// Whether the one triangle still decides, and if so what it says.
DEVICE uint hit_held(Closest* closest, const Held* held, const RayFrame* frame, float reach,
                     GLOBAL const ShapeHeader* RESTRICT shape, GLOBAL const TriangleBlock* RESTRICT blocks) {
    if (held->triangle != NONE)
        hit_lane(closest, frame, blocks + shape->triangle_block_first + held->triangle / TRIANGLE_LANES,
                 held->triangle % TRIANGLE_LANES, shape->tolerance, false);
    const float met = closest->back < closest->front ? closest->back : closest->front;
    return (uint)(met + LIMIT_TOLERANCES * shape->tolerance <= held->limit) | (uint)(held->limit >= reach);
}

// What is known of a ray from now on, where it had to be cast.
DEVICE_RARE Held seek_tube(const SourceRay* ray, const Closest* own, GLOBAL const Holder* RESTRICT holder,
                           GLOBAL const ShapeHeader* RESTRICT shape, GLOBAL const Node* RESTRICT nodes,
                           GLOBAL const TriangleBlock* RESTRICT blocks) {
    Held held = nothing_held(NONE);
    for (int i = 0; i < 3; ++i) {
        held.position[i] = ray->position[i];
        held.direction[i] = ray->direction[i];
    }
    const float met = own->back < own->front ? own->back : own->front;
    const float end = met + holder->radius < ray->reach ? met + holder->radius : ray->reach;
    if (holder->radius <= 0.0f || end >= UNBOUNDED) return held;
    const Tube tube = tube_of(ray, end, holder->radius);
    const Neighbours found = search_tube(&tube, holder->radius, shape, nodes, blocks);
    const float safe = found.second - holder->margin;
    if (safe > WORTH_HOLDING * holder->radius) {
        held.safe = safe;
        held.limit = end;
        held.triangle = found.slot;
    } else {
        held.limit = WAIT_STEPS;
    }
    return held;
}

// Rays that are not known by what was held. after: of those whose pair is not idle, what was held; then, what is held
// from now on.
DEVICE_BATCH void cast_waiting(Group* waiting, GLOBAL const Holder* RESTRICT holders,
                               GLOBAL const ShapeHeader* RESTRICT shapes, GLOBAL const Node* RESTRICT nodes,
                               GLOBAL const TriangleBlock* RESTRICT blocks, GLOBAL const Packed3* RESTRICT normals,
                               GLOBAL Held* RESTRICT after, GLOBAL Hit* RESTRICT hits) {
    Closest own[RAYS_IN_GROUP];
    cast_group(own, waiting, 1u, shapes, nodes, blocks, normals, hits);
    for (uint r = 0u; r < waiting->count; ++r) {
        GLOBAL const Holder* holder = holders + waiting->pair[r];
        if (is_idle(holder)) continue;
        const uint at = waiting->at[r];
        const SourceRay source = ray_of(waiting, r);
        GLOBAL const ShapeHeader* shape = shapes + waiting->target[r];
        Held held = after[at];
        const float waits = held.safe > 0.0f ? 0.0f : held.limit - 1.0f;
        const uint slot = held.slot;
        held.limit = waits;
        if (!(waits > 0.0f)) held = seek_tube(&source, own + r, holder, shape, nodes, blocks);
        held.slot = slot;
        after[at] = held;
    }
    waiting->count = 0u;
}

// The hits of cast_rays_bvh, bit for bit; none of vertices outside the bounds. before, after: rays held in the last
// step and now, those of idle pairs left as they are; casts: 1 for each ray cast in full.
KERNEL void hold_rays(RANGE uint count, GLOBAL const OrderedPair* RESTRICT pairs, GLOBAL const Holder* RESTRICT holders,
                      GLOBAL const ShapeHeader* RESTRICT shapes, GLOBAL const VertexBlock* RESTRICT vertices,
                      GLOBAL const Node* RESTRICT nodes, GLOBAL const TriangleBlock* RESTRICT blocks,
                      GLOBAL const Packed3* RESTRICT normals, GLOBAL const Ray* RESTRICT rays,
                      GLOBAL const Held* RESTRICT before, GLOBAL Held* RESTRICT after, GLOBAL Hit* RESTRICT hits,
                      GLOBAL uint* RESTRICT casts) {
    Group waiting;
    clear_group(&waiting);
    FOR_EACH(i, count) {
        const Ray ray = rays[i];
        if (i + 8u < count) {
            PREFETCH(pairs, rays[i + 8u].pair);
            PREFETCH(holders, rays[i + 8u].pair);
        }
        GLOBAL const Holder* holder = holders + ray.pair;
        const uint target = pairs[ray.pair].target;
        GLOBAL const ShapeHeader* shape = shapes + target;
        const SourceRay source = source_ray(pairs + ray.pair, vertices, ray.slot);
        const bool inside = in_bounds(pairs + ray.pair, source.position);
        bool known = false;
        if (!is_idle(holder)) {
            Held held = held_before(holder, before, ray.slot, i);
            if (inside && held.safe > 0.0f && moved_by(&held, &source) < held.safe) {
                const RayFrame frame = frame_ray(source.position, source.direction);
                Closest own = nothing_hit(source.reach, shape->tolerance);
                known = hit_held(&own, &held, &frame, source.reach, shape, blocks) != 0u;
                if (known) hits[i] = decide(CASTER_BVH, &source, &own, shape, nodes, blocks, normals);
            }
            after[i] = held;
        }
        // Not asked of the outside grid, of which most such rays would wait for a cell that says nothing.
        const bool cast = !known && inside;
        casts[i] = (uint)cast;
        if (cast)
            add_ray(&waiting, i, &source, source.reach, ray.pair, target, shapes);
        else if (!known)
            hits[i] = no_contact();
        if (is_full(&waiting)) cast_waiting(&waiting, holders, shapes, nodes, blocks, normals, after, hits);
    }
    if (RAYS_IN_GROUP > 1) cast_waiting(&waiting, holders, shapes, nodes, blocks, normals, after, hits);
}
// NOLINTEND(modernize-use-using)
