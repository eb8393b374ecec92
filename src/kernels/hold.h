// SPDX-License-Identifier: Apache-2.0
// Rays that need not be cast again (docs/certified.md). What is known by a tube (tube.h) lasts until a point of the ray
// has moved as far as that is wide: one triangle alone can be met, or none. What a triangle's cap says is asked anew in
// each step (cap_group.h).

#define WAIT_STEPS 3.0f     // before the next attempt, where a tube was hardly wide enough for one step
#define WORTH_HOLDING 0.02f // of the radius sought

// The place of a ray among those that its pair held, which ascend by slot, or of the first one after it. likely: its
// place among those of this step, mostly the same.
DEVICE uint find_held(READS(Held) held, uint count, uint slot, uint likely) {
    if (likely < count && held[likely].slot == slot) return likely;
    uint low = 0u, high = count;
    while (low < high) {
        const uint middle = (low + high) / 2u;
        if (held[middle].slot < slot)
            low = middle + 1u;
        else
            high = middle;
    }
    return low;
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
DEVICE bool is_idle(READS(HeldRange) held_range) {
    return held_range->count == 0u && held_range->radius <= 0.0f && held_range->asks_caps == 0u;
}

// What is known of a ray from now on, where it had to be cast.
DEVICE_RARE Held seek_tube(const SourceRay* ray, const Closest* own, READS(HeldRange) held_range,
                           READS(ShapeHeader) shape, READS(Node) nodes, READS(TriangleBlock) blocks) {
    Held held = nothing_held(NONE);
    for (int i = 0; i < 3; ++i) {
        held.position[i] = ray->position[i];
        held.direction[i] = ray->direction[i];
    }
    const float met = own->back < own->front ? own->back : own->front;
    const float end = met + held_range->radius < ray->reach ? met + held_range->radius : ray->reach;
    if (held_range->radius <= 0.0f || end >= UNBOUNDED) return held;
    const Tube tube = tube_of(ray, end, held_range->radius);
    const Neighbours found = search_tube(&tube, shape, nodes, blocks);
    const float safe = found.second - held_range->margin;
    if (safe > WORTH_HOLDING * held_range->radius) {
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
DEVICE_BATCH void cast_waiting(Group* waiting, READS(HeldRange) held_ranges, READS(ShapeHeader) shapes,
                               READS(Node) nodes, READS(TriangleBlock) blocks, READS(Face) faces,
                               READS(Packed3) normals, WRITES(Held) after, uint stride, WRITES(Hit) hits,
                               WRITES(uint) outcomes) {
    Closest own[RAYS_IN_GROUP];
    cast_group(own, waiting, shapes, nodes, blocks, normals, stride, hits, outcomes);
    for (uint r = 0u; r < waiting->count; ++r) {
        READS(HeldRange) held_range = held_ranges + waiting->pair[r];
        if (is_idle(held_range)) continue;
        const uint at = waiting->at[r];
        const SourceRay source = ray_of(waiting, r);
        READS(ShapeHeader) shape = shapes + waiting->target[r];
        Held held = after[at];
        const uint slot = held.slot;
        const bool had_tube = held.safe > 0.0f;
        const float waits = had_tube ? 0.0f : held.limit - 1.0f;
        held.limit = waits;
        const bool met = hits[at].triangle != NONE && held_range->asks_caps != 0u;
        const uint slot_met = met ? faces[shape->face_first + hits[at].triangle].slot : NONE;
        // A cap that holds the ray, and was asked in vain: an edge is near, or the surface. Then a tube may do.
        const bool in_vain = !had_tube && held.triangle == slot_met;
        if (slot_met != NONE && !in_vain
            && is_in_cap(&source, hits[at].facing, held_range->margin, shape, blocks, slot_met)) {
            held = nothing_held(slot);
            held.triangle = slot_met;
        } else if (!(waits > 0.0f)) {
            held = seek_tube(&source, own + r, held_range, shape, nodes, blocks);
        }
        held.slot = slot;
        after[at] = held;
    }
    waiting->count = 0u;
}

// The rays of a group that neither their tube nor a cap decides are cast.
DEVICE_BATCH void decide_held(HeldGroup* group, Group* waiting, READS(HeldRange) held_ranges, READS(ShapeHeader) shapes,
                              READS(Node) nodes, READS(TriangleBlock) blocks, READS(Face) faces, READS(Packed3) normals,
                              WRITES(Held) after, uint stride, WRITES(Hit) hits, WRITES(uint) outcomes) {
    fetch_triangles(group, shapes, blocks, normals);
    ask_tubes_and_caps(group, shapes, blocks, faces, normals);
    for (uint r = 0u; r < group->rays.count; ++r) {
        const uint at = group->rays.at[r];
        if (group->is_known[r] != 0u) {
            record_hit(held_hit(group, r, shapes, normals), 0u, at, stride, hits, outcomes);
            if (after[at].triangle != group->triangle_slot[r]) {
                after[at].triangle = group->triangle_slot[r];
                after[at].safe = after[at].limit = 0.0f;
            }
            continue;
        }
        const SourceRay source = ray_of(&group->rays, r);
        add_ray(waiting, at, &source, source.reach, group->rays.pair[r], group->rays.target[r], shapes);
        // A group of one is cast by the caller, so that all rays are cast in one place there.
        if (RAYS_IN_GROUP > 1 && is_full(waiting))
            cast_waiting(waiting, held_ranges, shapes, nodes, blocks, faces, normals, after, stride, hits, outcomes);
    }
    group->rays.count = 0u;
}

// The hits of cast_rays_bvh, bit for bit; none of vertices outside the bounds. before, after: rays held in the last
// step and now, those of idle pairs left as they are.
KERNEL void hold_rays(COUNT(count), uint stride, READS(OrderedPair) pairs, READS(HeldRange) held_ranges,
                      READS(ShapeHeader) shapes, READS(VertexBlock) vertices, READS(Node) nodes,
                      READS(TriangleBlock) blocks, READS(Face) faces, READS(Packed3) normals, READS(Ray) rays,
                      READS(Held) before, WRITES(Held) after, WRITES(Hit) hits, WRITES(uint) outcomes) {
    Group waiting;
    HeldGroup group;
    clear_group(&waiting);
    clear_held(&group);
    FOR_EACH(i, count) {
        const Ray ray = rays[i];
        if (i + 8u < i_end) {
            PREFETCH(pairs, rays[i + 8u].pair);
            PREFETCH(held_ranges, rays[i + 8u].pair);
        }
        READS(HeldRange) held_range = held_ranges + ray.pair;
        const uint target = pairs[ray.pair].target;
        const SourceRay source = source_ray(pairs + ray.pair, vertices, ray.slot);
        const bool inside = in_bounds(pairs + ray.pair, source.position);
        bool held = false;
        if (!is_idle(held_range)) {
            READS(Held) own = before + held_range->first;
            const uint place = find_held(own, held_range->count, ray.slot, i - held_range->now_first);
            const bool capped = held_range->asks_caps != 0u;
            Held known = nothing_held(ray.slot);
            if (place < held_range->count && own[place].slot == ray.slot) known = own[place];
            after[i] = known;
            if (capped && known.safe <= 0.0f && known.triangle == NONE)
                known.triangle = triangle_nearby(own, held_range->count, place);
            held = inside && (known.safe > 0.0f || (capped && known.triangle != NONE));
            if (held) add_held(&group, i, &source, &known, held_range, ray.pair, target, shapes, blocks);
        }
        if (!held) {
            // Not asked of the outside grid, of which most such rays would wait for a cell that says nothing.
            if (inside)
                add_ray(&waiting, i, &source, source.reach, ray.pair, target, shapes);
            else
                record_hit(no_contact(), 0u, i, stride, hits, outcomes);
        }
        if (is_full(&group.rays))
            decide_held(&group, &waiting, held_ranges, shapes, nodes, blocks, faces, normals, after, stride, hits,
                        outcomes);
        if (is_full(&waiting))
            cast_waiting(&waiting, held_ranges, shapes, nodes, blocks, faces, normals, after, stride, hits, outcomes);
    }
    if (RAYS_IN_GROUP > 1) {
        decide_held(&group, &waiting, held_ranges, shapes, nodes, blocks, faces, normals, after, stride, hits,
                    outcomes);
        cast_waiting(&waiting, held_ranges, shapes, nodes, blocks, faces, normals, after, stride, hits, outcomes);
    }
}
