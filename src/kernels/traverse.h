// SPDX-License-Identifier: Apache-2.0
// The two casters (paper section 5.1). Both give the same hit: the boxes contain every hit that counts.

DEVICE Closest nothing_hit(float reach, float tolerance) {
    const Closest closest = {UNBOUNDED, UNBOUNDED, NONE, reach < UNBOUNDED ? reach + tolerance : UNBOUNDED};
    return closest;
}

DEVICE void hit_lanes(Closest* closest, const RayFrame* ray, READS(TriangleBlock) block, uint lanes, float tolerance,
                      const bool by_distance) {
    for (; lanes != 0u; lanes &= lanes - 1u) hit_lane(closest, ray, block, lowest_bit(lanes), tolerance, by_distance);
}

// So many blocks are tested for one ray after another before any lane is tested exactly: a bit each, and few enough to
// stay in the first-level cache (20 of 32 KiB) for the next ray. A single ray needs no more than one.
#define BLOCKS_AHEAD (RAYS_AT_ONCE > 1 ? 32 : 1)

// All rays against the same shape. Lanes that pass are stored without a branch, since a misprediction would discard the
// tests already begun; each ray still takes them in their order.
DEVICE void traverse_basic(Closest* closest, const RayFrame* rays, uint ray_count, READS(ShapeHeader) shape,
                           READS(ulong) memory) {
    for (uint first = 0u; first < shape->triangle_block_count; first += BLOCKS_AHEAD) {
        READS(TriangleBlock) ahead = AT(memory, TriangleBlock, shape->triangle_blocks) + first;
        const uint left = shape->triangle_block_count - first;
        const uint block_count = left < BLOCKS_AHEAD ? left : BLOCKS_AHEAD;
        uint waiting[RAYS_AT_ONCE];
        uint lanes[RAYS_AT_ONCE][BLOCKS_AHEAD];
        for (uint r = 0u; r < ray_count; ++r) {
            uint some = 0u;
            for (uint b = 0u; b < block_count; ++b) {
                const uint found = hit_block(closest + r, rays + r, ahead + b, shape->tolerance, false);
                lanes[r][b] = found;
                some |= (uint)(found != 0u) << b;
            }
            waiting[r] = some;
        }
        for (uint r = 0u; r < ray_count; ++r) {
            for (uint some = waiting[r]; some != 0u; some &= some - 1u) {
                const uint b = lowest_bit(some);
                hit_lanes(closest + r, rays + r, ahead + b, lanes[r][b], shape->tolerance, false);
            }
        }
    }
}

// A ray and its opposite in one pass (paper section 5.3): the block test covers the line in both directions, so the
// second ray costs only its exact tests.
DEVICE void traverse_basic_line(Closest* closest, const RayFrame* ray, Closest* ahead, const RayFrame* opposite,
                                READS(ShapeHeader) shape, READS(ulong) memory) {
    for (uint b = 0u; b < shape->triangle_block_count; ++b) {
        READS(TriangleBlock) block = AT(memory, TriangleBlock, shape->triangle_blocks) + b;
        const uint lanes = hit_block(closest, ray, block, shape->tolerance, false);
        if (lanes != 0u) {
            hit_lanes(closest, ray, block, lanes, shape->tolerance, false);
            hit_lanes(ahead, opposite, block, lanes, shape->tolerance, false);
        }
    }
}

// Whether a ray meets a box within the limit. It meets the box's near planes at n and the far ones at f.
DEVICE uint meets_box(float nx, float ny, float nz, float fx, float fy, float fz, float limit, float tolerance) {
    const float nxy = nx > ny ? nx : ny, nzt = nz > -tolerance ? nz : -tolerance;
    const float fxy = fx < fy ? fx : fy, fzt = fz < limit ? fz : limit;
    const float enter = nxy > nzt ? nxy : nzt;
    const float leave = fxy < fzt ? fxy : fzt;
    return (uint)(enter <= leave);
}

// A bit for each child box that the ray meets no farther than the limit.
DEVICE uint hit_children(const RayFrame* ray, READS(Node) node, float limit, float tolerance) {
    // Rows of Node.bounds that the ray meets first.
    const uint x = ray->inverse[0] < 0.0f ? 3u : 0u, y = ray->inverse[1] < 0.0f ? 4u : 1u;
    const uint z = ray->inverse[2] < 0.0f ? 5u : 2u;
    READS(float) near_x = node->bounds[x];
    READS(float) near_y = node->bounds[y];
    READS(float) near_z = node->bounds[z];
    READS(float) far_x = node->bounds[3u - x];
    READS(float) far_y = node->bounds[5u - y];
    READS(float) far_z = node->bounds[7u - z];
    const float px = ray->raw_origin[0], py = ray->raw_origin[1], pz = ray->raw_origin[2];
    const float ix = ray->inverse[0], iy = ray->inverse[1], iz = ray->inverse[2];
    int hit[NODE_LANES];
    FOR_LANES(k, NODE_LANES) {
        const float nx = (near_x[k] - px) * ix, ny = (near_y[k] - py) * iy, nz = (near_z[k] - pz) * iz;
        const float fx = (far_x[k] - px) * ix, fy = (far_y[k] - py) * iy, fz = (far_z[k] - pz) * iz;
        hit[k] = -(int)meets_box(nx, ny, nz, fx, fy, fz, limit, tolerance);
    }
    return pack_sixteen(hit);
}

// Boxes of a node, of triangles or of bodies, that reach into a box: lower x y z, upper x y z.
DEVICE uint lanes_in(const float* box, GLOBAL const float (*RESTRICT bounds)[NODE_LANES]) {
    int within[NODE_LANES];
    FOR_LANES(k, NODE_LANES) {
        const uint x = (bounds[0][k] <= box[3]) & (bounds[3][k] >= box[0]);
        const uint y = (bounds[1][k] <= box[4]) & (bounds[4][k] >= box[1]);
        const uint z = (bounds[2][k] <= box[5]) & (bounds[5][k] >= box[2]);
        within[k] = -(int)(x & y & z);
    }
    return pack_sixteen(within);
}

// Stackless: sixteen bits a level remember the children still to visit, parents are linked (after Barringer and
// Akenine-Moeller 2013). Going up tests nothing again.
STRUCT(Descent) {
    ulong trail;
    uint at, children; // a node, and those of its children still to visit, a bit each
};

// Removes the next child, a node or a leaf, from those to visit.
DEVICE uint next_child(Descent* way, READS(Node) tree) {
    const uint child = tree[way->at].child[lowest_bit(way->children)];
    way->children &= way->children - 1u;
    return child;
}

DEVICE void go_down(Descent* way, uint child, uint children) {
    way->trail = (way->trail << NODE_LANES) | (ulong)way->children;
    way->at = child;
    way->children = children;
}

DEVICE void go_up(Descent* way, READS(Node) tree) {
    way->at = tree[way->at].parent;
    way->children = (uint)(way->trail & 0xffffu);
    way->trail >>= NODE_LANES;
}

// By value: the address of a caller's struct would be one in local memory on a GPU.
DEVICE_CALL Closest traverse_bvh(const RayFrame given, float reach, READS(ShapeHeader) shape, READS(ulong) memory) {
    const RayFrame* ray = &given;
    Closest closest = nothing_hit(reach, shape->tolerance);
    READS(Node) tree = AT(memory, Node, shape->nodes);
    READS(TriangleBlock) blocks = AT(memory, TriangleBlock, shape->triangle_blocks);
    Descent way = {0u, 0u, hit_children(ray, tree, closest.limit, shape->tolerance)};
    for (;;) {
        while (way.children != 0u) {
            const uint child = next_child(&way, tree);
            if ((child & LEAF) != 0u) {
                READS(TriangleBlock) block = blocks + (child & ~LEAF);
                const uint lanes = hit_block(&closest, ray, block, shape->tolerance, true);
                hit_lanes(&closest, ray, block, lanes, shape->tolerance, true);
            } else {
                go_down(&way, child, hit_children(ray, tree + child, closest.limit, shape->tolerance));
            }
        }
        if (way.at == 0u) return closest;
        go_up(&way, tree);
    }
}
