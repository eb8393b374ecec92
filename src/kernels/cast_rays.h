// SPDX-License-Identifier: Apache-2.0
// Rays from the vertices of one mesh along their inward normals into the other (Hermann et al. 2008; paper
// section 2.1).

#define SIDE_DIRECTIONS 4
#define CASTER_BASIC 0
#define CASTER_BVH 1

// -1: the closest face is met from outside, or none is met; 1: from inside; 0: two such faces are within rounding.
DEVICE int verdict(const Closest* closest, float reach, float tolerance) {
    if (closest->back >= UNBOUNDED || closest->back > reach) return -1;
    if (closest->front + tolerance < closest->back) return -1;
    return closest->back + tolerance < closest->front ? 1 : 0;
}

// The shapes that casting kernels read, and the results that they write. Columns of outcomes: the ray is a
// contact; its side tests; it was cast in full.
STRUCT(RayArrays) {
    READS(ShapeHeader) shapes;
    READS(ulong) memory;
    uint stride; // of outcomes
    WRITES(Hit) hits;
    WRITES(uint) outcomes;
};

DEVICE Closest traverse(const RayArrays* arrays, const uint caster, const RayFrame* ray, float reach,
                        READS(ShapeHeader) shape) {
    if (caster == CASTER_BVH) return traverse_bvh(*ray, reach, shape, arrays->memory);
    Closest closest = nothing_hit(reach, shape->tolerance);
    traverse_basic(&closest, ray, 1u, shape, arrays->memory);
    return closest;
}

// The closest hits of a group's rays, or of the opposite rays, by the BVH. A group of several rays is cast together,
// each as far as its `length`; a hit so near is the closest of all. The other rays are cast one by one.
DEVICE void find_group(const RayArrays* arrays, Closest* own, RayGroup* group, const bool opposite) {
    frame_group(group, opposite);
    const uint alone = RAYS_IN_GROUP > 1 ? traverse_group(own, group, arrays->memory) : 1u;
    for (uint r = 0u; r < group->count; ++r) {
        const float length = group->length[r], reach = group->reach[r];
        if (((alone >> r) & 1u) == 0u && (length >= reach || own[r].back <= length || own[r].front <= length)) continue;
        const RayFrame frame = frame_of(group, r);
        own[r] = traverse(arrays, CASTER_BVH, &frame, reach, group->shape[r]);
    }
}

DEVICE Hit no_contact(uint sides) {
    const Hit hit = {NONE, 0.0f, 0.0f, sides};
    return hit;
}

// The hit of a ray that meets the triangle from inside.
DEVICE Hit hit_of(const RayArrays* arrays, const SourceRay* ray, READS(ShapeHeader) shape, uint triangle,
                  float distance, uint sides) {
    const Packed3 n = AT(arrays->memory, Packed3, shape->face_normals)[triangle];
    const float facing = (ray->direction[0] * n.x + ray->direction[1] * n.y) + ray->direction[2] * n.z;
    const Hit hit = {triangle, distance, facing, sides};
    return hit;
}

// A contact has a positive depth: a ray that only grazes the face it leaves through separates nothing.
DEVICE uint is_contact(const Hit hit) {
    return (uint)(hit.triangle != NONE) & (uint)(hit.distance * hit.facing > 0.0f);
}

DEVICE void record_hit(const RayArrays* arrays, uint at, const Hit hit, uint was_cast) {
    arrays->hits[at] = hit;
    arrays->outcomes[at] = is_contact(hit);
    arrays->outcomes[arrays->stride + at] = hit.sides;
    arrays->outcomes[2u * arrays->stride + at] = was_cast;
}

// Of a ray in a direction that is unrelated to the others and to any axis. No table: a GPU would keep it in its slow
// local memory.
DEVICE RayFrame side_frame(const SourceRay* ray, uint side) {
    const float direction[3] = {side == 3u ? 0.8123f : component(side, 0.5402f, -0.6311f, -0.2917f),
                                side == 3u ? -0.4461f : component(side, 0.3173f, 0.7213f, -0.8349f),
                                side == 3u ? -0.3758f : component(side, 0.7794f, 0.2856f, 0.4667f)};
    return frame_ray(ray->position, direction, false);
}

// A vertex is in contact exactly when the closest hit within reach is a face met from inside. If the closest front and
// back faces lie within rounding of each other (silhouettes, thin sheets), float32 could order them wrongly and invent
// a contact a body size away. Then other directions from the same point decide whether it is inside a closed mesh. An
// open mesh has no inside: there such a ray is no contact.
DEVICE Hit decide(const RayArrays* arrays, const uint caster, const SourceRay* ray, const Closest* own,
                  READS(ShapeHeader) shape) {
    int decided = verdict(own, ray->reach, shape->tolerance);
    uint sides = 0u;
    while (decided == 0 && shape->closed != 0u && sides < SIDE_DIRECTIONS) {
        const RayFrame frame = side_frame(ray, sides);
        const Closest side = traverse(arrays, caster, &frame, UNBOUNDED, shape);
        decided = verdict(&side, UNBOUNDED, shape->tolerance);
        ++sides;
    }
    return decided > 0 ? hit_of(arrays, ray, shape, own->back_triangle, own->back, sides) : no_contact(sides);
}

// Casts the rays of a group, decides each of them and records its hit.
DEVICE void cast_group(const RayArrays* arrays, Closest* own, RayGroup* group) {
    find_group(arrays, own, group, false);
    for (uint r = 0u; r < group->count; ++r)
        if (own[r].back < UNBOUNDED)
            PREFETCH(AT(arrays->memory, Packed3, group->shape[r]->face_normals), own[r].back_triangle);
    for (uint r = 0u; r < group->count; ++r) {
        const SourceRay ray = ray_of(group, r);
        record_hit(arrays, group->at[r], decide(arrays, CASTER_BVH, &ray, own + r, group->shape[r]), 1u);
    }
}

// All vertices are inside the bounds.
KERNEL void cast_rays_bvh(COUNT(count), uint stride, READS(DirectedPair) pairs, READS(ShapeHeader) shapes,
                          READS(ulong) memory, READS(Ray) rays, WRITES(Hit) hits, WRITES(uint) outcomes) {
    const RayArrays arrays = {shapes, memory, stride, hits, outcomes};
    FOR_EACH_FEW(i, few, RAYS_IN_GROUP, count) {
        RayGroup group;
        Closest own[RAYS_IN_GROUP];
        clear_group(&group);
        for (uint r = 0u; r < few; ++r) {
            const Ray ray = rays[i + r];
            READS(DirectedPair) pair = pairs + ray.pair;
            const SourceRay source = source_ray(pair, shapes, memory, ray.vertex_lane);
            add_ray(&group, i + r, &source, source.reach, ray.pair, shapes + pair->target);
        }
        cast_group(&arrays, own, &group);
    }
}

// A vertex that has left the bounds is no contact, whatever its ray meets.
KERNEL void cast_rays_basic(COUNT(count), uint stride, READS(DirectedPair) pairs, READS(ShapeHeader) shapes,
                            READS(ulong) memory, READS(Ray) rays, WRITES(Hit) hits, WRITES(uint) outcomes) {
    const RayArrays arrays = {shapes, memory, stride, hits, outcomes};
    FOR_EACH_FEW(i, few, RAYS_AT_ONCE, count) {
        SourceRay source[RAYS_AT_ONCE];
        RayFrame frame[RAYS_AT_ONCE];
        Closest own[RAYS_AT_ONCE];
        for (uint r = 0u; r < few; ++r) {
            const Ray ray = rays[i + r];
            READS(DirectedPair) pair = pairs + ray.pair;
            source[r] = source_ray(pair, shapes, memory, ray.vertex_lane);
            frame[r] = frame_ray(source[r].position, source[r].direction, false);
            own[r] = nothing_hit(source[r].reach, shapes[pair->target].tolerance);
        }
        for (uint r = 0u, same = 1u; r < few; r += same, same = 1u) {
            const uint target = pairs[rays[i + r].pair].target;
            while (r + same < few && pairs[rays[i + r + same].pair].target == target) ++same;
            traverse_basic(own + r, frame + r, same, shapes + target, memory);
        }
        for (uint r = 0u; r < few; ++r) {
            READS(DirectedPair) pair = pairs + rays[i + r].pair;
            READS(ShapeHeader) shape = shapes + pair->target;
            record_hit(&arrays, i + r,
                       in_bounds(pair, source[r].position) ? decide(&arrays, CASTER_BASIC, source + r, own + r, shape)
                                                           : no_contact(0u),
                       1u);
        }
    }
}
