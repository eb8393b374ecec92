// SPDX-License-Identifier: Apache-2.0
// The neighbourhood of a ray, up to a little behind its hit: the nearest triangle, and the distance of all others.

STRUCT(SweptClearance) {
    float origin[3];
    float along[3], u[3], v[3]; // unit vectors, square to each other
    float length;
    float radius;
    float box[6]; // around the swept clearance: lower x y z, upper x y z
};

// The triangle nearest to the ray, and how far the ray is from every other. triangle_lane: TRIANGLE_LANES * block +
// lane.
STRUCT(Neighbours) {
    float least, second;
    uint triangle_lane;
};

// end: in lengths of the ray's direction.
DEVICE SweptClearance swept_clearance_of(const SourceRay* ray, float end, float radius) {
    SweptClearance swept;
    swept.radius = radius;
    const float* d = ray->direction;
    // Rotations are rigid only to 1e-4: the direction is not quite a unit vector, and distances count in its lengths.
    const float size = root_of((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]);
    for (int i = 0; i < 3; ++i) {
        swept.origin[i] = ray->position[i];
        swept.along[i] = d[i] / size;
    }
    swept.length = end * size;
    const float ax = magnitude_of(swept.along[0]), ay = magnitude_of(swept.along[1]), az = magnitude_of(swept.along[2]);
    const int across = ax < ay ? (ax < az ? 0 : 2) : (ay < az ? 1 : 2);
    const int next = across == 2 ? 0 : across + 1, last = next == 2 ? 0 : next + 1;
    const float side = 1.0f / root_of(swept.along[next] * swept.along[next] + swept.along[last] * swept.along[last]);
    swept.u[across] = 0.0f;
    swept.u[next] = -(swept.along[last] * side);
    swept.u[last] = swept.along[next] * side;
    for (int i = 0; i < 3; ++i) {
        const int j = i == 2 ? 0 : i + 1, k = j == 2 ? 0 : j + 1;
        swept.v[i] = swept.along[j] * swept.u[k] - swept.along[k] * swept.u[j];
        const float last_point = swept.origin[i] + swept.length * swept.along[i];
        swept.box[i] = (swept.origin[i] < last_point ? swept.origin[i] : last_point) - radius;
        swept.box[3 + i] = (swept.origin[i] > last_point ? swept.origin[i] : last_point) + radius;
    }
    return swept;
}

// Separation of the origin from a 2D triangle along the normal of its edge from a to b; c is the third corner.
DEVICE float edge_gap(float au, float av, float bu, float bv, float cu, float cv) {
    const float nu = bv - av, nv = au - bu, n2 = nu * nu + nv * nv;
    const float scale = n2 > 1.0e-30f ? 0.9999f / root_of(n2) : 0.0f;
    const float edge = (nu * au + nv * av) * scale, third = (nu * cu + nv * cv) * scale;
    const float low = edge < third ? edge : third, high = edge > third ? edge : third;
    return low > -high ? low : -high;
}

// A triangle is at least as far from the axis as along any separating direction. It tries the axis, the triangle's
// normal and, seen along the axis, the normals of its edges. Any direction is valid, so rounding one does no harm.
DEVICE void nearest_lanes(Neighbours* found, const SweptClearance* swept, READS(TriangleBlock) block, uint index) {
    float apart[TRIANGLE_LANES];
    int nearer[TRIANGLE_LANES];
    const float ox = swept->origin[0], oy = swept->origin[1], oz = swept->origin[2];
    const float dx = swept->along[0], dy = swept->along[1], dz = swept->along[2];
    const float px = swept->u[0], py = swept->u[1], pz = swept->u[2];
    const float qx = swept->v[0], qy = swept->v[1], qz = swept->v[2];
    const float length = swept->length, bound = found->second;
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
        nearer[k] = -(int)(best < bound); // false for NaN, in empty lanes
    }
    for (uint left = pack_sixteen(nearer); left != 0u; left &= left - 1u) {
        const uint lane = lowest_bit(left);
        if (apart[lane] < found->least) {
            found->second = found->least;
            found->least = apart[lane];
            found->triangle_lane = TRIANGLE_LANES * index + lane;
        } else if (apart[lane] < found->second) {
            found->second = apart[lane];
        }
    }
}

// Child boxes that may reach into the swept clearance. A long swept clearance's own box holds much of a fine mesh; seen
// along the axis, few boxes are near it.
DEVICE uint children_in_clearance(const SweptClearance* swept, READS(Node) node) {
    const float ux = swept->u[0], uy = swept->u[1], uz = swept->u[2];
    const float vx = swept->v[0], vy = swept->v[1], vz = swept->v[2];
    const float aux = magnitude_of(ux), auy = magnitude_of(uy), auz = magnitude_of(uz);
    const float avx = magnitude_of(vx), avy = magnitude_of(vy), avz = magnitude_of(vz);
    const float ox = 2.0f * swept->origin[0], oy = 2.0f * swept->origin[1], oz = 2.0f * swept->origin[2];
    const float twice = 2.0f * swept->radius;
    int within[NODE_LANES];
    FOR_LANES(k, NODE_LANES) {
        // Everything doubled: twice the middle, and the sides.
        const float cx = (node->bounds[0][k] + node->bounds[3][k]) - ox, sx = node->bounds[3][k] - node->bounds[0][k];
        const float cy = (node->bounds[1][k] + node->bounds[4][k]) - oy, sy = node->bounds[4][k] - node->bounds[1][k];
        const float cz = (node->bounds[2][k] + node->bounds[5][k]) - oz, sz = node->bounds[5][k] - node->bounds[2][k];
        const float u = magnitude_of((ux * cx + uy * cy) + uz * cz), v = magnitude_of((vx * cx + vy * cy) + vz * cz);
        const float most_u = ((aux * sx + auy * sy) + auz * sz) + twice;
        const float most_v = ((avx * sx + avy * sy) + avz * sz) + twice;
        within[k] = -(int)((u <= most_u) & (v <= most_v));
    }
    return pack_sixteen(within) & lanes_in(swept->box, node->bounds);
}

// Searches all triangles in the swept clearance.
DEVICE_CALL Neighbours search_clearance(const SweptClearance* swept, READS(ShapeHeader) shape, READS(ulong) memory) {
    Neighbours found;
    found.least = found.second = swept->radius;
    found.triangle_lane = NONE;
    READS(Node) tree = AT(memory, Node, shape->nodes);
    READS(TriangleBlock) blocks = AT(memory, TriangleBlock, shape->triangle_blocks);
    Descent way = {0u, 0u, children_in_clearance(swept, tree)};
    for (;;) {
        while (way.children != 0u) {
            const uint child = next_child(&way, tree);
            if ((child & LEAF) != 0u) {
                const uint index = child & ~LEAF;
                nearest_lanes(&found, swept, blocks + index, index);
            } else {
                go_down(&way, child, children_in_clearance(swept, tree + child));
            }
        }
        if (way.at == 0u) return found;
        go_up(&way, tree);
    }
}
