// SPDX-License-Identifier: Apache-2.0
// Held rays that no tube decides, asked of their triangles' caps (cap.h) together, and from triangle to triangle; and
// where rays without a triangle begin.

#define OUTSIDE_TOLERANCES 4.0f
#define MOST_STEPS 16u   // before a ray is cast instead
#define PLACES_NEARBY 4u // to either side

// After ask_held(). A ray that begins in the triangle's cap and passes well inside of its edges leaves the mesh there,
// and there alone; one that begins beyond it is outside, if by more than rounding.
DEVICE void ask_caps(HeldGroup* group) {
    Group* rays = &group->rays;
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
        const float facing = facing_in_cap(group->cap[r], tolerance, group->margin[r], far2, along);
        const uint faces_alike = (uint)(facing >= CAP_LEAST_FACING);
        const uint outside = (uint)(t * facing <= -OUTSIDE_TOLERANCES * tolerance);
        const uint known = faces_alike & group->is_inside_edges[r] & ((uint)(t >= 0.0f) | outside);

        const float u = group->edge[0][r], v = group->edge[1][r], w = group->edge[2][r];
        const uint by_u = (uint)(u >= v) & (uint)(u >= w), by_v = (by_u ^ 1u) & (uint)(v >= w);
        const uint edge = 3u - 2u * by_u - by_v;
        const uint exceeds = (uint)(u > 0.0f) | (uint)(v > 0.0f) | (uint)(w > 0.0f);
        const uint in_tube = group->is_known[r];
        group->beyond[r] = edge & (0u - (faces_alike & exceeds & ((known | in_tube) ^ 1u)));
        group->is_known[r] = known | in_tube;
        group->is_hit[r] = (known & group->is_exit[r]) | ((known ^ 1u) & group->is_hit[r]);
    }
}

// Rays that passed their triangle by go on to the one across that edge. Returns how many did.
DEVICE uint step_over(HeldGroup* group, READS(ShapeHeader) shapes, READS(TriangleBlock) blocks, READS(Face) faces,
                      READS(Packed3) normals) {
    uint stepped = 0u;
    for (uint r = 0u; r < group->rays.count; ++r) {
        if (group->beyond[r] == 0u) continue;
        READS(Face) own = faces + shapes[group->rays.target[r]].face_first;
        const uint next = own[group->triangle[r]].neighbour[group->beyond[r] - 1u];
        const uint slot = next != NONE ? own[next].slot : NONE;
        if (slot == NONE) continue;
        group->triangle_slot[r] = slot;
        group->safe[r] = 0.0f; // its tube was of the other triangle
        fetch_triangle(group, r, shapes, blocks, normals);
        ++stepped;
    }
    return stepped;
}

// What held rays' tubes say, else their caps.
DEVICE void ask_tubes_and_caps(HeldGroup* group, READS(ShapeHeader) shapes, READS(TriangleBlock) blocks,
                               READS(Face) faces, READS(Packed3) normals) {
    ask_held(group);
    uint asks = 0u;
    for (uint r = 0u; r < group->rays.count; ++r) asks |= group->asks_cap[r] & (group->is_known[r] ^ 1u);
    if (asks == 0u) return;
    ask_caps(group);
    for (uint step = 0u; step < MOST_STEPS && step_over(group, shapes, blocks, faces, normals) != 0u; ++step) {
        ask_held(group);
        ask_caps(group);
    }
}

// A triangle that a ray beside that place was known by: from there a ray without one may find its own.
DEVICE uint triangle_nearby(READS(Held) held, uint count, uint place) {
    for (uint k = 0u; k < PLACES_NEARBY; ++k) {
        if (place + k < count && held[place + k].triangle != NONE) return held[place + k].triangle;
        if (k < place && held[place - 1u - k].triangle != NONE) return held[place - 1u - k].triangle;
    }
    return NONE;
}
