// SPDX-License-Identifier: Apache-2.0
// Normal-cone balls (docs/internals/certified.md): each triangle of a closed, outward mesh has balls around its centre
// in which all normals are within an angle of its own. A ray that begins in such a ball and runs along these normals
// leaves the mesh at most once. ShapeHeader.normal_cones: the radii of two such balls, for a narrow angle in the lower
// half; 0: none. Rays that no swept clearance decides are tested against the normal-cone balls of their triangles, as a
// group, and go on to neighbours.

#define CONE_UNIT_TOLERANCES 2.0f // a step of the stored radii
// The two angles: 30 and 55 degrees.
#define CONE_NARROW_COSINE 0.8660254f
#define CONE_NARROW_SINE 0.5f
#define CONE_WIDE_COSINE 0.5735764f
#define CONE_WIDE_SINE 0.8191520f
#define CONE_LEAST_FACING 0.125f  // least cosine of ray and normal for a normal-cone ball to decide
#define CONE_LOST_OF_FACING 0.01f // lost to rounding of the triangle's normal and of the ray's direction
#define OUTSIDE_TOLERANCES 4.0f
#define MOST_STEPS 16u   // before a ray is cast instead
#define PLACES_NEARBY 4u // to either side

// A lower bound of the cosine between a ray's direction and any normal in the triangle's normal-cone ball; -1: the ray
// begins outside the normal-cone ball. far2: squared distance of its origin from the triangle's centre; along: cosine
// of direction and the triangle's own normal; margin: metres of rounding.
DEVICE float facing_in_cone(uint cone, float tolerance, float margin, float far2, float along) {
    const float unit = CONE_UNIT_TOLERANCES * tolerance;
    const float narrow = (float)(int)(cone & 0xffffu) * unit - margin, wide = (float)(int)(cone >> 16) * unit - margin;
    const float across2 = 1.0f - along * along, across = root_of(across2 > 0.0f ? across2 : 0.0f);
    const float in_narrow = (CONE_NARROW_COSINE * along - CONE_NARROW_SINE * across) - CONE_LOST_OF_FACING;
    const float in_wide = (CONE_WIDE_COSINE * along - CONE_WIDE_SINE * across) - CONE_LOST_OF_FACING;
    // The narrow ball lies in the wide one.
    const uint is_in_wide = (uint)(wide > 0.0f) & (uint)(far2 < wide * wide);
    const uint is_in_narrow = (uint)(narrow > 0.0f) & (uint)(far2 < narrow * narrow);
    return component(2u - is_in_wide - is_in_narrow, in_narrow, in_wide, -1.0f);
}

// Whether the normal-cone ball of the triangle that a ray met can decide the ray in later steps.
DEVICE bool is_in_cone(const SourceRay* ray, float facing, float margin, READS(ShapeHeader) shape, READS(ulong) memory,
                       uint triangle_lane) {
    READS(TriangleBlock) block = AT(memory, TriangleBlock, shape->triangle_blocks) + triangle_lane / TRIANGLE_LANES;
    const uint lane = triangle_lane % TRIANGLE_LANES;
    float far2 = 0.0f;
    for (int i = 0; i < 3; ++i) {
        const float middle = (block->corner[i][lane] + block->corner[3 + i][lane]) + block->corner[6 + i][lane];
        const float off = middle * (1.0f / 3.0f) - ray->position[i];
        far2 += off * off;
    }
    const uint cone = AT(memory, uint, shape->normal_cones)[triangle_lane];
    return facing_in_cone(cone, shape->tolerance, margin, far2, facing) >= CONE_LEAST_FACING;
}

// Called after test_held(). A ray that begins in the triangle's normal-cone ball and passes well inside its edges
// leaves the mesh there and nowhere else. If it begins beyond the triangle by more than rounding, its vertex is
// outside.
DEVICE void test_cones(HeldGroup* group) {
    RayGroup* rays = &group->rays;
    FOR_LANES(r, RAYS_IN_GROUP) {
        const float px = rays->position[0][r], py = rays->position[1][r], pz = rays->position[2][r];
        const float ax = group->corner[0][r] - px, ay = group->corner[1][r] - py, az = group->corner[2][r] - pz;
        const float bx = group->corner[3][r] - px, by = group->corner[4][r] - py, bz = group->corner[5][r] - pz;
        const float cx = group->corner[6][r] - px, cy = group->corner[7][r] - py, cz = group->corner[8][r] - pz;
        const float third = 1.0f / 3.0f;
        const float middle_x = ((ax + bx) + cx) * third, middle_y = ((ay + by) + cy) * third;
        const float middle_z = ((az + bz) + cz) * third;
        const float far2 = (middle_x * middle_x + middle_y * middle_y) + middle_z * middle_z;
        const float abx = bx - ax, aby = by - ay, abz = bz - az, acx = cx - ax, acy = cy - ay, acz = cz - az;
        const float nx = aby * acz - abz * acy, ny = abz * acx - abx * acz, nz = abx * acy - aby * acx;
        const float n2 = (nx * nx + ny * ny) + nz * nz;
        const float dx = rays->direction[0][r], dy = rays->direction[1][r], dz = rays->direction[2][r];
        const float along = n2 > 1.0e-30f ? ((nx * dx + ny * dy) + nz * dz) / root_of(n2) : 0.0f;
        const float tolerance = rays->tolerance[r], t = group->distance[r];
        const float facing = facing_in_cone(group->cone[r], tolerance, group->margin[r], far2, along);
        const uint faces_alike = (uint)(facing >= CONE_LEAST_FACING);
        const uint outside = (uint)(t * facing <= -OUTSIDE_TOLERANCES * tolerance);
        const uint known = faces_alike & group->is_inside_edges[r] & ((uint)(t >= 0.0f) | outside);

        const float u = group->edge[0][r], v = group->edge[1][r], w = group->edge[2][r];
        const uint by_u = (uint)(u >= v) & (uint)(u >= w), by_v = (by_u ^ 1u) & (uint)(v >= w);
        const uint edge = 3u - 2u * by_u - by_v;
        const uint exceeds = (uint)(u > 0.0f) | (uint)(v > 0.0f) | (uint)(w > 0.0f);
        const uint in_clearance = group->is_known[r];
        group->beyond[r] = edge & (0u - (faces_alike & exceeds & ((known | in_clearance) ^ 1u)));
        group->is_known[r] = known | in_clearance;
        group->is_hit[r] = (known & group->is_exit[r]) | ((known ^ 1u) & group->is_hit[r]);
    }
}

// Rays that missed their triangle go on to the neighbour across the edge `beyond`. Returns how many did.
DEVICE uint step_over(const RayArrays* arrays, HeldGroup* group) {
    uint stepped = 0u;
    for (uint r = 0u; r < group->rays.count; ++r) {
        if (group->beyond[r] == 0u) continue;
        READS(Face) own = AT(arrays->memory, Face, group->rays.shape[r]->faces);
        const uint next = own[group->triangle[r]].neighbour[group->beyond[r] - 1u];
        const uint triangle_lane = next != NONE ? own[next].triangle_lane : NONE;
        if (triangle_lane == NONE) continue;
        group->triangle_lane[r] = triangle_lane;
        group->safe[r] = 0.0f; // its swept clearance was of the other triangle
        fetch_triangle(arrays, group, r);
        ++stepped;
    }
    return stepped;
}

// Decides rays by their swept clearances, and the others by their normal-cone balls.
DEVICE void test_clearances_and_cones(const RayArrays* arrays, HeldGroup* group) {
    test_held(group);
    uint undecided = 0u;
    for (uint r = 0u; r < group->rays.count; ++r) undecided |= group->tests_cones[r] & (group->is_known[r] ^ 1u);
    if (undecided == 0u) return;
    test_cones(group);
    for (uint step = 0u; step < MOST_STEPS && step_over(arrays, group) != 0u; ++step) {
        test_held(group);
        test_cones(group);
    }
}

// The triangle of a ray near that place: a ray without a triangle begins its search there.
DEVICE uint triangle_nearby(READS(Held) held, uint count, uint place) {
    for (uint k = 0u; k < PLACES_NEARBY; ++k) {
        if (place + k < count && held[place + k].triangle != NONE) return held[place + k].triangle;
        if (k < place && held[place - 1u - k].triangle != NONE) return held[place - 1u - k].triangle;
    }
    return NONE;
}
