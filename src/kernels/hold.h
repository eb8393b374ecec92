// SPDX-License-Identifier: Apache-2.0
// Rays that need not be cast again (docs/internals/certified.md). A swept clearance (swept_clearance.h) lasts until a
// point of the ray has moved by its radius: until then the ray can meet only one triangle, or none. A triangle's
// normal-cone ball is tested in each step (normal_cone.h).

#define WAIT_STEPS 3.0f     // before the next search, if the last swept clearance was hardly wide enough for one step
#define WORTH_HOLDING 0.02f // of the search radius

// The place of a ray among those kept of its pair, which ascend by vertex_lane, or of the first one after it. likely:
// its place among the rays of this step, mostly the same.
DEVICE uint find_held(READS(Held) held, uint count, uint vertex_lane, uint likely) {
    if (likely < count && held[likely].vertex_lane == vertex_lane) return likely;
    uint low = 0u, high = count;
    while (low < high) {
        const uint middle = (low + high) / 2u;
        if (held[middle].vertex_lane < vertex_lane)
            low = middle + 1u;
        else
            high = middle;
    }
    return low;
}

DEVICE Held nothing_held(uint vertex_lane) {
    const Held held = {vertex_lane, NONE, 0.0f, 0.0f, {0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}};
    return held;
}

// Nothing was kept of the pair's rays, and nothing will be.
DEVICE bool is_idle(READS(HeldRange) held_range) {
    return held_range->count == 0u && held_range->radius <= 0.0f && held_range->tests_cones == 0u;
}

// Searches a swept clearance around a ray that was cast. Returns what is kept of the ray.
DEVICE_BATCH Held seek_clearance(const RayArrays* arrays, const SourceRay* ray, const Closest* own,
                                 READS(HeldRange) held_range, READS(ShapeHeader) shape) {
    Held held = nothing_held(NONE);
    for (int i = 0; i < 3; ++i) {
        held.position[i] = ray->position[i];
        held.direction[i] = ray->direction[i];
    }
    const float met = own->back < own->front ? own->back : own->front;
    const float end = met + held_range->radius < ray->reach ? met + held_range->radius : ray->reach;
    if (held_range->radius <= 0.0f || end >= UNBOUNDED) return held;
    const SweptClearance swept = swept_clearance_of(ray, end, held_range->radius);
    const Neighbours found = search_clearance(&swept, shape, arrays->memory);
    const float safe = found.second - held_range->margin;
    if (safe > WORTH_HOLDING * held_range->radius) {
        held.safe = safe;
        held.limit = end;
        held.triangle = found.triangle_lane;
    } else {
        held.limit = WAIT_STEPS;
    }
    return held;
}

// before, after: what was kept of rays in the last step, and what is kept in this one; not written for idle pairs.
STRUCT(Holding) {
    RayArrays all;
    READS(HeldRange) held_ranges; // by pair
    READS(Held) before;
    WRITES(Held) after;
};

// Casts rays that neither a swept clearance nor a normal-cone ball decides. `after`, if their pair is not idle: what
// was kept of them becomes what is kept from now on.
DEVICE_BATCH void cast_waiting(const Holding* hold, RayGroup* waiting) {
    Closest own[RAYS_IN_GROUP];
    cast_group(&hold->all, own, waiting);
    for (uint r = 0u; r < waiting->count; ++r) {
        READS(HeldRange) held_range = hold->held_ranges + waiting->pair[r];
        if (is_idle(held_range)) continue;
        const uint at = waiting->at[r];
        const SourceRay source = ray_of(waiting, r);
        const Hit hit = hold->all.hits[at];
        READS(ShapeHeader) shape = waiting->shape[r];
        Held held = hold->after[at];
        const uint vertex_lane = held.vertex_lane;
        const bool had_clearance = held.safe > 0.0f;
        const float waits = had_clearance ? 0.0f : held.limit - 1.0f;
        held.limit = waits;
        const bool met = hit.triangle != NONE && held_range->tests_cones != 0u;
        const uint lane_met = met ? AT(hold->all.memory, Face, shape->faces)[hit.triangle].triangle_lane : NONE;
        // The normal-cone ball of the triangle that the ray meets was tested and did not decide: an edge or the surface
        // is near. A swept clearance may.
        const bool cone_failed = !had_clearance && held.triangle == lane_met;
        if (lane_met != NONE && !cone_failed
            && is_in_cone(&source, hit.facing, held_range->margin, shape, hold->all.memory, lane_met)) {
            held = nothing_held(vertex_lane);
            held.triangle = lane_met;
        } else if (!(waits > 0.0f)) {
            held = seek_clearance(&hold->all, &source, own + r, held_range, shape);
        }
        held.vertex_lane = vertex_lane;
        hold->after[at] = held;
    }
    waiting->count = 0u;
}

// Does not test the outside grid: most such rays would wait for a cell that decides nothing.
DEVICE void cast_later(const Holding* hold, RayGroup* waiting, uint at, const SourceRay* ray, uint pair,
                       READS(ShapeHeader) shape) {
    add_ray(waiting, at, ray, ray->reach, pair, shape);
    if (is_full(waiting)) cast_waiting(hold, waiting);
}

// The rays of a group that neither their swept clearance nor a normal-cone ball decides are cast.
DEVICE_BATCH void decide_held(const Holding* hold, HeldGroup* group, RayGroup* waiting) {
    const RayGroup* rays = &group->rays;
    fetch_triangles(&hold->all, group);
    test_clearances_and_cones(&hold->all, group);
    for (uint r = 0u; r < rays->count; ++r) {
        const uint at = rays->at[r];
        if (group->is_known[r] == 0u) {
            const SourceRay source = ray_of(rays, r);
            cast_later(hold, waiting, at, &source, rays->pair[r], rays->shape[r]);
            continue;
        }
        record_hit(&hold->all, at, held_hit(&hold->all, group, r), 0u);
        WRITES(Held) held = hold->after + at;
        if (held->triangle != group->triangle_lane[r]) {
            held->triangle = group->triangle_lane[r];
            held->safe = held->limit = 0.0f;
        }
    }
    group->rays.count = 0u;
}

// Adds a ray inside the bounds to the group if a swept clearance or a normal-cone ball may decide it. Returns whether
// it did.
DEVICE bool add_if_kept(const Holding* hold, HeldGroup* group, uint at, const Ray ray, const SourceRay* source,
                        READS(ShapeHeader) shape, bool inside) {
    READS(HeldRange) held_range = hold->held_ranges + ray.pair;
    if (is_idle(held_range)) return false;
    READS(Held) own = hold->before + held_range->first;
    const uint place = find_held(own, held_range->count, ray.vertex_lane, at - held_range->now_first);
    const bool has_cones = held_range->tests_cones != 0u;
    Held known = nothing_held(ray.vertex_lane);
    // The first rays of a pair seek their swept clearances in the course of four steps.
    if (held_range->count == 0u) known.limit = 1.0f + (float)(ray.vertex_lane & 3u);
    if (place < held_range->count && own[place].vertex_lane == ray.vertex_lane) known = own[place];
    hold->after[at] = known;
    if (has_cones && known.safe <= 0.0f && known.triangle == NONE)
        known.triangle = triangle_nearby(own, held_range->count, place);
    if (!inside || !(known.safe > 0.0f || (has_cones && known.triangle != NONE))) return false;
    add_held(&hold->all, group, at, source, &known, held_range, ray.pair, shape);
    return true;
}

// Gives the hits of cast_rays_bvh, bit for bit; vertices outside the bounds have none.
KERNEL void hold_rays(COUNT(count), uint stride, READS(DirectedPair) pairs, READS(HeldRange) held_ranges,
                      READS(ShapeHeader) shapes, READS(ulong) memory, READS(Ray) rays, READS(Held) before,
                      WRITES(Held) after, WRITES(Hit) hits, WRITES(uint) outcomes) {
    const Holding hold = {{shapes, memory, stride, hits, outcomes}, held_ranges, before, after};
    RayGroup waiting;
    HeldGroup group{};
    clear_group(&waiting);
    FOR_EACH(i, count) {
        const Ray ray = rays[i];
        if (i + 8u < i_end) {
            PREFETCH(pairs, rays[i + 8u].pair);
            PREFETCH(held_ranges, rays[i + 8u].pair);
        }
        READS(ShapeHeader) shape = shapes + pairs[ray.pair].target;
        const SourceRay source = source_ray(pairs + ray.pair, shapes, memory, ray.vertex_lane);
        const bool inside = in_bounds(pairs + ray.pair, source.position);
        if (add_if_kept(&hold, &group, i, ray, &source, shape, inside)) {
            if (is_full(&group.rays)) decide_held(&hold, &group, &waiting);
        } else if (inside) {
            cast_later(&hold, &waiting, i, &source, ray.pair, shape);
        } else {
            record_hit(&hold.all, i, no_contact(0u), 0u);
        }
    }
    decide_held(&hold, &group, &waiting);
    cast_waiting(&hold, &waiting);
}
