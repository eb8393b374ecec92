// SPDX-License-Identifier: Apache-2.0
// Rays from the vertices of one mesh along their inward normals into the other (Hermann et al. 2008; paper
// section 2.1).
// NOLINTBEGIN(modernize-redundant-void-arg): this text is C as well

#define SIDE_DIRECTIONS 4
#define CASTER_BASIC 0
#define CASTER_BVH 1

// Directions unrelated to each other and to any axis, for the rare ray whose own direction cannot tell.
DEVICE float side_direction(uint i, uint axis) {
    const float table[3 * SIDE_DIRECTIONS] = {0.5402f,  0.3173f,  0.7794f, -0.6311f, 0.7213f,  0.2856f,
                                              -0.2917f, -0.8349f, 0.4667f, 0.8123f,  -0.4461f, -0.3758f};
    return table[3u * i + axis];
}

// -1: a face met from outside comes first, or nothing is hit; 1: one met from inside; 0: within rounding of each other.
DEVICE int verdict(const Closest* closest, float reach, float tolerance) {
    if (closest->back >= UNBOUNDED || closest->back > reach) return -1;
    if (closest->front + tolerance < closest->back) return -1;
    return closest->back + tolerance < closest->front ? 1 : 0;
}

DEVICE Closest traverse(const uint caster, const RayFrame* ray, float reach, READS(ShapeHeader) shape,
                        READS(Node) nodes, READS(TriangleBlock) blocks) {
    if (caster == CASTER_BVH) return traverse_bvh(ray, reach, shape, nodes, blocks);
    Closest closest = nothing_hit(reach, shape->tolerance);
    traverse_basic(&closest, ray, 1u, shape, blocks);
    return closest;
}

// What each ray of a group meets first, or its opposite, by the BVH. Where a group is more than one ray, they are cast
// together as far as each one's `length`: what is met so near is the closest of all. The others are cast alone.
DEVICE void find_group(Closest* own, Group* group, const bool opposite, READS(ShapeHeader) shapes, READS(Node) nodes,
                       READS(TriangleBlock) blocks) {
    frame_group(group, opposite);
    const uint alone = RAYS_IN_GROUP > 1 ? traverse_group(own, group, nodes, blocks) : 1u;
    for (uint r = 0u; r < group->count; ++r) {
        const float length = group->length[r], reach = group->reach[r];
        if (((alone >> r) & 1u) == 0u && (length >= reach || own[r].back <= length || own[r].front <= length)) continue;
        const RayFrame frame = frame_of(group, r);
        own[r] = traverse_bvh(&frame, reach, shapes + group->target[r], nodes, blocks);
    }
}

DEVICE Hit no_contact(void) {
    Hit hit;
    hit.triangle = NONE;
    hit.distance = 0.0f;
    hit.facing = 0.0f;
    hit.sides = 0u;
    return hit;
}

// A contact has a positive depth: a ray that only grazes the face it leaves through separates nothing.
DEVICE uint is_contact(const Hit hit) {
    return (uint)(hit.triangle != NONE) & (uint)(hit.distance * hit.facing > 0.0f);
}

// How a ray ended. Columns of outcomes: it is a contact; its side tests; it was cast in full.
DEVICE void record_hit(const Hit hit, uint was_cast, uint at, uint stride, WRITES(Hit) hits, WRITES(uint) outcomes) {
    hits[at] = hit;
    outcomes[at] = is_contact(hit);
    outcomes[stride + at] = hit.sides;
    outcomes[2u * stride + at] = was_cast;
}

// In contact exactly when the closest hit within reach is a face met from inside. Where the closest front and back
// faces lie within rounding of each other (silhouettes, thin sheets), float32 could order them wrongly and invent a
// contact a body size away: then other directions from the same point decide whether it is inside a closed mesh.
// An open mesh has no inside, so there such a ray is no contact.
DEVICE Hit decide(const uint caster, const SourceRay* ray, const Closest* own, READS(ShapeHeader) shape,
                  READS(Node) nodes, READS(TriangleBlock) blocks, READS(Packed3) normals) {
    int decided = verdict(own, ray->reach, shape->tolerance);
    uint sides = 0u;
    while (decided == 0 && shape->closed != 0u && sides < SIDE_DIRECTIONS) {
        const float direction[3] = {side_direction(sides, 0u), side_direction(sides, 1u), side_direction(sides, 2u)};
        const RayFrame frame = frame_ray(ray->position, direction);
        const Closest side = traverse(caster, &frame, UNBOUNDED, shape, nodes, blocks);
        decided = verdict(&side, UNBOUNDED, shape->tolerance);
        ++sides;
    }
    Hit hit = no_contact();
    hit.sides = sides;
    if (decided > 0) {
        const Packed3 n = normals[shape->normal_first + own->back_triangle];
        hit.triangle = own->back_triangle;
        hit.distance = own->back;
        hit.facing = (ray->direction[0] * n.x + ray->direction[1] * n.y) + ray->direction[2] * n.z;
    }
    return hit;
}

// What the rays of a group meet, and what that makes of each of them: hits by whose they are.
DEVICE void cast_group(Closest* own, Group* group, READS(ShapeHeader) shapes, READS(Node) nodes,
                       READS(TriangleBlock) blocks, READS(Packed3) normals, uint stride, WRITES(Hit) hits,
                       WRITES(uint) outcomes) {
    find_group(own, group, false, shapes, nodes, blocks);
    for (uint r = 0u; r < group->count; ++r)
        if (own[r].back < UNBOUNDED) PREFETCH(normals, shapes[group->target[r]].normal_first + own[r].back_triangle);
    for (uint r = 0u; r < group->count; ++r) {
        const SourceRay ray = ray_of(group, r);
        record_hit(decide(CASTER_BVH, &ray, own + r, shapes + group->target[r], nodes, blocks, normals), 1u,
                   group->at[r], stride, hits, outcomes);
    }
}

// Every vertex is in the bounds.
KERNEL void cast_rays_bvh(COUNT(count), uint stride, READS(OrderedPair) pairs, READS(ShapeHeader) shapes,
                          READS(VertexBlock) vertices, READS(Node) nodes, READS(TriangleBlock) blocks,
                          READS(Packed3) normals, READS(Ray) rays, WRITES(Hit) hits, WRITES(uint) outcomes) {
    FOR_EACH_FEW(i, few, RAYS_IN_GROUP, count) {
        Group group;
        Closest own[RAYS_IN_GROUP];
        clear_group(&group);
        for (uint r = 0u; r < few; ++r) {
            const Ray ray = rays[i + r];
            const uint target = pairs[ray.pair].target;
            const SourceRay source = source_ray(pairs + ray.pair, vertices, ray.slot);
            add_ray(&group, i + r, &source, source.reach, ray.pair, target, shapes);
        }
        cast_group(own, &group, shapes, nodes, blocks, normals, stride, hits, outcomes);
    }
}

// A vertex that has left the bounds is no contact, whatever its ray meets.
KERNEL void cast_rays_basic(COUNT(count), uint stride, READS(OrderedPair) pairs, READS(ShapeHeader) shapes,
                            READS(VertexBlock) vertices, READS(Node) nodes, READS(TriangleBlock) blocks,
                            READS(Packed3) normals, READS(Ray) rays, WRITES(Hit) hits, WRITES(uint) outcomes) {
    FOR_EACH_FEW(i, few, RAYS_AT_ONCE, count) {
        SourceRay source[RAYS_AT_ONCE];
        RayFrame frame[RAYS_AT_ONCE];
        Closest own[RAYS_AT_ONCE];
        for (uint r = 0u; r < few; ++r) {
            const Ray ray = rays[i + r];
            READS(OrderedPair) pair = pairs + ray.pair;
            source[r] = source_ray(pair, vertices, ray.slot);
            frame[r] = frame_ray(source[r].position, source[r].direction);
            own[r] = nothing_hit(source[r].reach, shapes[pair->target].tolerance);
        }
        for (uint r = 0u, same = 1u; r < few; r += same, same = 1u) {
            const uint target = pairs[rays[i + r].pair].target;
            while (r + same < few && pairs[rays[i + r + same].pair].target == target) ++same;
            traverse_basic(own + r, frame + r, same, shapes + target, blocks);
        }
        for (uint r = 0u; r < few; ++r) {
            READS(OrderedPair) pair = pairs + rays[i + r].pair;
            const Hit hit = in_bounds(pair, source[r].position) ? decide(CASTER_BASIC, source + r, own + r,
                                                                         shapes + pair->target, nodes, blocks, normals)
                                                                : no_contact();
            record_hit(hit, 1u, i + r, stride, hits, outcomes);
        }
    }
}
// NOLINTEND(modernize-redundant-void-arg)
