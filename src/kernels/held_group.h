// SPDX-License-Identifier: Apache-2.0
// Tests whether what is kept of a ray (Held) still decides it (docs/internals/certified.md), for a group of rays, one
// in each lane. Nearly every ray at rest is decided so.

#define LIMIT_TOLERANCES 4.0f
#define EDGE_TOLERANCES 4.0f

// Rays, and what was kept of each. All zero at first, since lanes without a ray or a triangle are tested, too.
STRUCT(HeldGroup) {
    RayGroup rays;
    float position[3][RAYS_IN_GROUP], direction[3][RAYS_IN_GROUP]; // when the clearance was searched
    float safe[RAYS_IN_GROUP], limit[RAYS_IN_GROUP];
    uint triangle_lane[RAYS_IN_GROUP]; // NONE: it has no triangle
    uint triangle[RAYS_IN_GROUP];      // of its shape
    uint cone[RAYS_IN_GROUP];          // of the triangle
    uint tests_cones[RAYS_IN_GROUP];
    float margin[RAYS_IN_GROUP];    // of rounding, metres
    float corner[9][RAYS_IN_GROUP]; // [3 * corner + axis]
    uint is_known[RAYS_IN_GROUP], is_hit[RAYS_IN_GROUP];
    float distance[RAYS_IN_GROUP]; // of a hit
    // For normal-cone balls (normal_cone.h), of every ray with a triangle. edge: the edge functions of its line;
    // is_inside_edges: whether the line passes well inside all edges; is_exit: whether the ray leaves the target there,
    // a hit if it can meet no other triangle. `distance` is then that of the triangle's plane.
    float edge[3][RAYS_IN_GROUP];
    uint is_inside_edges[RAYS_IN_GROUP], is_exit[RAYS_IN_GROUP];
    uint beyond[RAYS_IN_GROUP]; // 1 to 3: the edge across which the normal-cone ball of the neighbour is tested next;
                                // 0: none
};

// Each of the triangle's words lies in a cache line of its own.
DEVICE void prefetch_triangle(READS(TriangleBlock) block, uint lane) {
    PREFETCH(block->triangle, lane);
    for (int k = 0; k < 9; ++k) PREFETCH((GLOBAL const float*)block->corner, TRIANGLE_LANES * k + lane);
}

DEVICE void add_held(const RayArrays* arrays, HeldGroup* group, uint at, const SourceRay* ray, const Held* held,
                     READS(HeldRange) held_range, uint pair, READS(ShapeHeader) shape) {
    const uint r = group->rays.count;
    add_ray(&group->rays, at, ray, ray->reach, pair, shape);
    for (int i = 0; i < 3; ++i) {
        group->position[i][r] = held->position[i];
        group->direction[i][r] = held->direction[i];
    }
    group->safe[r] = held->safe;
    group->limit[r] = held->limit;
    group->margin[r] = held_range->margin;
    group->tests_cones[r] = held_range->tests_cones;
    group->triangle_lane[r] = held->triangle;
    group->cone[r] = 0u;
    if (held->triangle == NONE) return;
    READS(TriangleBlock) blocks = AT(arrays->memory, TriangleBlock, shape->triangle_blocks);
    prefetch_triangle(blocks + held->triangle / TRIANGLE_LANES, held->triangle % TRIANGLE_LANES);
    if (held_range->tests_cones != 0u) PREFETCH(AT(arrays->memory, uint, shape->normal_cones), held->triangle);
}

DEVICE void fetch_triangle(const RayArrays* arrays, HeldGroup* group, uint r) {
    const uint triangle_lane = group->triangle_lane[r], lane = triangle_lane % TRIANGLE_LANES;
    READS(ShapeHeader) shape = group->rays.shape[r];
    READS(TriangleBlock) blocks = AT(arrays->memory, TriangleBlock, shape->triangle_blocks);
    READS(TriangleBlock) block = blocks + triangle_lane / TRIANGLE_LANES;
    for (int k = 0; k < 9; ++k) group->corner[k][r] = block->corner[k][lane];
    group->triangle[r] = block->triangle[lane];
    group->cone[r] = group->tests_cones[r] != 0u ? AT(arrays->memory, uint, shape->normal_cones)[triangle_lane] : 0u;
    PREFETCH(AT(arrays->memory, Packed3, shape->face_normals), group->triangle[r]);
}

// Loads what add_held() has prefetched.
DEVICE void fetch_triangles(const RayArrays* arrays, HeldGroup* group) {
    for (uint r = 0u; r < group->rays.count; ++r)
        if (group->triangle_lane[r] != NONE) fetch_triangle(arrays, group, r);
}

// First tests whether any part of the ray has left its swept clearance: no point of it has moved farther than one of
// its ends. Then tests the triangle with the result of hit_lane(), and whether any other triangle can matter.
DEVICE void test_held(HeldGroup* group) {
    RayGroup* rays = &group->rays;
    frame_group(rays, false);
    FOR_LANES(r, RAYS_IN_GROUP) {
        const float px = rays->position[0][r], py = rays->position[1][r], pz = rays->position[2][r];
        const float limit = group->limit[r];
        const float x = px - group->position[0][r], y = py - group->position[1][r], z = pz - group->position[2][r];
        const float turned_x = rays->direction[0][r] - group->direction[0][r];
        const float turned_y = rays->direction[1][r] - group->direction[1][r];
        const float turned_z = rays->direction[2][r] - group->direction[2][r];
        const float far_x = x + limit * turned_x, far_y = y + limit * turned_y, far_z = z + limit * turned_z;
        const float start = (x * x + y * y) + z * z, end = (far_x * far_x + far_y * far_y) + far_z * far_z;
        const uint in_clearance = (uint)(root_of(start > end ? start : end) < group->safe[r]);

        const uint to_x = rays->axis[0][r], to_y = rays->axis[1][r], to_z = rays->axis[2][r];
        const float shear_x = rays->shear[0][r], shear_y = rays->shear[1][r], shear_z = rays->shear[2][r];
        const float ax = group->corner[0][r] - px, ay = group->corner[1][r] - py, az = group->corner[2][r] - pz;
        const float bx = group->corner[3][r] - px, by = group->corner[4][r] - py, bz = group->corner[5][r] - pz;
        const float cx = group->corner[6][r] - px, cy = group->corner[7][r] - py, cz = group->corner[8][r] - pz;
        const float z0 = component(to_z, ax, ay, az), z1 = component(to_z, bx, by, bz);
        const float z2 = component(to_z, cx, cy, cz);
        const float x0 = component(to_x, ax, ay, az) - shear_x * z0;
        const float y0 = component(to_y, ax, ay, az) - shear_y * z0;
        const float x1 = component(to_x, bx, by, bz) - shear_x * z1;
        const float y1 = component(to_y, bx, by, bz) - shear_y * z1;
        const float x2 = component(to_x, cx, cy, cz) - shear_x * z2;
        const float y2 = component(to_y, cx, cy, cz) - shear_y * z2;
        const Edges e = edges_of(x0, y0, x1, y1, x2, y2);
        const float t = distance_of(e, z0, z1, z2, shear_z);

        const float tolerance = rays->tolerance[r], reach = rays->reach[r];
        const float least = reach < UNBOUNDED ? reach + tolerance : UNBOUNDED; // as in nothing_hit()
        const float t0 = z0 * shear_z, t1 = z1 * shear_z, t2 = z2 * shear_z;
        const float beyond = least + tolerance, behind = -2.0f * tolerance;
        const uint away = ((uint)(t0 > beyond) & (uint)(t1 > beyond) & (uint)(t2 > beyond))
                          | ((uint)(t0 < behind) & (uint)(t1 < behind) & (uint)(t2 < behind));
        const uint back = (uint)(e.u <= 0.0f) & (uint)(e.v <= 0.0f) & (uint)(e.w <= 0.0f);
        const uint front = (uint)(e.u >= 0.0f) & (uint)(e.v >= 0.0f) & (uint)(e.w >= 0.0f);
        const uint within = (uint)(t <= least) & (uint)(t < UNBOUNDED);
        const uint taken = within & ((back & (uint)(t >= 0.0f)) | (front & (back ^ 1u) & (uint)(t >= -tolerance)));
        const uint met = taken & (away ^ 1u) & (uint)(area_of(e) != 0.0f) & (uint)(group->triangle_lane[r] != NONE);
        const uint alone = (met & (uint)(t + LIMIT_TOLERANCES * tolerance <= limit)) | (uint)(limit >= reach);

        const float edge_margin = EDGE_TOLERANCES * tolerance;
        const uint inside_edges = (uint)(e.u < -edge_margin * (magnitude_of(x2 - x1) + magnitude_of(y2 - y1)))
                                  & (uint)(e.v < -edge_margin * (magnitude_of(x0 - x2) + magnitude_of(y0 - y2)))
                                  & (uint)(e.w < -edge_margin * (magnitude_of(x1 - x0) + magnitude_of(y1 - y0)));
        const uint exits = within & (uint)(t >= 0.0f) & (uint) !(t > reach);
        const uint known = in_clearance & alone;
        group->edge[0][r] = e.w; // as Face numbers them
        group->edge[1][r] = e.u;
        group->edge[2][r] = e.v;
        group->is_inside_edges[r] = inside_edges;
        group->is_exit[r] = exits;
        group->is_known[r] = known;
        group->is_hit[r] = known & met & back & (uint) !(t > reach);
        group->distance[r] = t;
    }
}

// The result of decide(). A single triangle cannot be confused with another, so no other direction is cast.
DEVICE Hit held_hit(const RayArrays* arrays, const HeldGroup* group, uint r) {
    const SourceRay ray = ray_of(&group->rays, r);
    return group->is_hit[r] != 0u
               ? hit_of(arrays, &ray, group->rays.shape[r], group->triangle[r], group->distance[r], 0u)
               : no_contact(0u);
}
