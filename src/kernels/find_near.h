// SPDX-License-Identifier: Apache-2.0
// Finds the edges of the source that may cross faces of the target, and casts them as segments
// (docs/internals/edges.md); the same of edges, and of vertices as points, that come near faces on their way
// (docs/internals/speculative.md). In float32, with a margin for all that this could hide: the host decides in double
// what was found.

#define DIAGONAL_TOLERANCES 1048576.0f // ShapeHeader.tolerance is 2^-20 of the box diagonal

#define MOST_CLEAR 1.0e9f // PairBlock.clear

DEVICE float least_of_vertices(const float* values) {
    if (VERTICES_AT_ONCE == 16) return least_of_sixteen(values);
    float least = values[0];
    for (int k = 1; k < VERTICES_AT_ONCE; ++k) least = values[k] < least ? values[k] : least;
    return least;
}

// A pair half-way to the next step: its points are half-way on straight ways. Returns how far a point of the source is
// from there at most, metres: none is farther from the middle of its shape than half the diagonal of its box.
DEVICE float go_half_way(READS(DirectedPair) now, READS(DirectedPair) next, READS(ShapeHeader) shapes,
                         WRITES(DirectedPair) half_way) {
    float shift = 0.0f, turn = 0.0f;
    for (int i = 0; i < 3; ++i) {
        const float by = 0.5f * (next->translation[i] - now->translation[i]);
        half_way->translation[i] = now->translation[i] + by;
        shift += by * by;
    }
    for (int i = 0; i < 9; ++i) {
        const float by = 0.5f * (next->rotation[i] - now->rotation[i]);
        half_way->rotation[i] = now->rotation[i] + by;
        turn += by * by;
    }
    for (int i = 0; i < 6; ++i) half_way->bounds[i] = now->bounds[i];
    half_way->source = now->source;
    half_way->target = now->target;
    const float reach = 0.5f * DIAGONAL_TOLERANCES * shapes[now->source].tolerance;
    return 1.001f * (root_of(shift) + reach * root_of(turn));
}

DEVICE float sizes_of(READS(DirectedPair) pair, READS(ShapeHeader) shapes) {
    return DIAGONAL_TOLERANCES * (shapes[pair->source].tolerance + shapes[pair->target].tolerance);
}

// Metres that a point of the source may be off in the target's frame: by the rounding of the pose and of the point, and
// by three perturbations by which the rule moves vertices.
DEVICE float placed_within(READS(DirectedPair) pair, READS(ShapeHeader) shapes) {
    READS(float) t = pair->translation;
    const float apart = (magnitude_of(t[0]) + magnitude_of(t[1])) + magnitude_of(t[2]);
    return 1.3e-6f * sizes_of(pair, shapes) + 2.0e-6f * apart;
}

// Metres within which an edge must be asked: how far points may be off, and twice what the two directions of a pair
// differ by, since poses are rigid only to 1e-4. Directions lie side by side. horizons: where edges are looked for,
// `ahead` and half their way beyond the margins; more, ahead: null for 0. half_way: of the pairs on their way to
// `next`; both null: they stay. thrown: of vertices on their way, how far one with little of its own body behind it may
// be thrown: half the way of the pair, and no more than a part of the smaller body; else null.
KERNEL void find_margins(COUNT(count), READS(DirectedPair) pairs, READS(DirectedPair) next, READS(float) more,
                         READS(float) ahead, READS(ShapeHeader) shapes, WRITES(float) margins, WRITES(float) horizons,
                         WRITES(DirectedPair) half_way, WRITES(float) thrown) {
    FOR_EACH(p, count) {
        READS(DirectedPair) there = pairs + p;
        READS(DirectedPair) back = pairs + (p ^ 1u);
        if (there->source == NONE) {
            if (next) half_way[p].source = NONE;
            continue;
        }
        READS(float) r = there->rotation;
        float shear = 0.0f, off = 0.0f;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j)
                shear +=
                    magnitude_of(((r[i] * r[j] + r[3 + i] * r[3 + j]) + r[6 + i] * r[6 + j]) - (i == j ? 1.0f : 0.0f));
            READS(float) row = back->rotation + 3 * i;
            READS(float) t = there->translation;
            off += magnitude_of(((row[0] * t[0] + row[1] * t[1]) + row[2] * t[2]) + back->translation[i]);
        }
        margins[p] =
            (more ? more[p] : 0.0f) + (placed_within(there, shapes) + (shear * sizes_of(there, shapes) + 2.0f * off));
        horizons[p] = margins[p] + (ahead ? ahead[p] : 0.0f);
        if (!next) continue;
        const float from_there = go_half_way(there, next + p, shapes, half_way + p);
        horizons[p] += from_there;
        if (!thrown) continue;
        const float one = shapes[there->source].tolerance, two = shapes[there->target].tolerance;
        const float most = 1.001f * MOST_THROWN * DIAGONAL_TOLERANCES * (one < two ? one : two);
        thrown[p] = from_there < most ? from_there : most;
        if (shapes[there->source].least_exit < thrown[p]) horizons[p] += thrown[p];
    }
}

// Sources on their way to the next step, in the target's frame: their middles and half edges half-way there. A vertex
// is the edge that is its way.
STRUCT(MovingLanes) {
    float middle[3][VERTICES_AT_ONCE], half_edge[3][VERTICES_AT_ONCE];
    float reach[3][VERTICES_AT_ONCE]; // of all that an edge passes, by axis, from its middle
    float length[VERTICES_AT_ONCE];   // of half an edge
    float away[VERTICES_AT_ONCE];     // how far a point of it is from its place half-way, at most
};

// No way: an edge passes itself alone, a vertex is a point.
DEVICE void place_sources(MovingLanes* lanes, uint vertices, READS(DirectedPair) pair, READS(VertexBlock) block,
                          uint first) {
    float r[9], t[3];
    for (int k = 0; k < 9; ++k) r[k] = pair->rotation[k];
    for (int k = 0; k < 3; ++k) t[k] = pair->translation[k];
    const float arm = vertices != 0u ? 0.0f : 1.0f;
    for (int i = 0; i < 3; ++i) {
        FOR_LANES(k, VERTICES_AT_ONCE) {
            const float vx = block->position[0][first + k], vy = block->position[1][first + k];
            const float vz = block->position[2][first + k];
            const float hx = block->direction[0][first + k], hy = block->direction[1][first + k];
            const float hz = block->direction[2][first + k];
            lanes->middle[i][k] = ((r[3 * i] * vx + r[3 * i + 1] * vy) + r[3 * i + 2] * vz) + t[i];
            lanes->half_edge[i][k] = arm * ((r[3 * i] * hx + r[3 * i + 1] * hy) + r[3 * i + 2] * hz);
            lanes->reach[i][k] = magnitude_of(lanes->half_edge[i][k]);
        }
    }
    FOR_LANES(k, VERTICES_AT_ONCE) {
        const float hx = block->direction[0][first + k], hy = block->direction[1][first + k];
        const float hz = block->direction[2][first + k];
        lanes->length[k] = arm * root_of((hx * hx + hy * hy) + hz * hz);
        lanes->away[k] = 0.0f;
    }
}

// Their ways, of those that lie half-way. thrown: 0, or vertices with less of their own body behind them are sought so
// much farther off.
DEVICE void move_sources(MovingLanes* lanes, uint vertices, READS(DirectedPair) next, float thrown,
                         READS(VertexBlock) block, uint first) {
    MovingLanes then;
    float way2[VERTICES_AT_ONCE] = {0}, turn2[VERTICES_AT_ONCE] = {0}, farther[VERTICES_AT_ONCE];
    place_sources(&then, vertices, next, block, first);
    FOR_LANES(k, VERTICES_AT_ONCE) {
        farther[k] = block->exit[first + k] < thrown ? thrown : 0.0f;
    }
    for (int i = 0; i < 3; ++i) {
        FOR_LANES(k, VERTICES_AT_ONCE) {
            const float way = then.middle[i][k] - lanes->middle[i][k];
            const float turn = then.half_edge[i][k] - lanes->half_edge[i][k];
            if (vertices != 0u) lanes->half_edge[i][k] = way;
            lanes->reach[i][k] = (magnitude_of(lanes->half_edge[i][k]) + farther[k])
                                 + (vertices != 0u ? 0.0f : magnitude_of(way) + magnitude_of(turn));
            way2[k] += way * way;
            turn2[k] += turn * turn;
        }
    }
    FOR_LANES(k, VERTICES_AT_ONCE) {
        const float way = 1.0001f * root_of(way2[k]);
        lanes->length[k] = vertices != 0u ? way : lanes->length[k];
        lanes->away[k] = farther[k] + (vertices != 0u ? 0.0f : way + 1.0001f * root_of(turn2[k]));
    }
}

// The edges of each block that come into the bounds, but for those that the clearance grid knows to be far from the
// surface: it does not enter the balls around their halves. vertices: 1: of vertices, as points. next: where the pairs
// will be; null: they stay. Of pairs with `ahead` (null: none) it tells, too, how far the others stay away, but of
// nothing that is farther than that.
KERNEL void count_edges(COUNT(count), uint vertices, READS(DirectedPair) pairs, READS(DirectedPair) next,
                        READS(float) thrown, READS(float) margins, READS(EdgeChoice) choices, READS(float) ahead,
                        READS(ShapeHeader) shapes, READS(ulong) memory, WRITES(PairBlock) found_blocks,
                        WRITES(uint) counts) {
    FOR_EACH_VERTICES(i, first, count) {
        READS(DirectedPair) pair = pairs + found_blocks[i].pair;
        READS(VertexBlock) block = source_block(pair, shapes, memory, found_blocks[i].vertex_block);
        const float margin = margins[found_blocks[i].pair];
        const EdgeChoice choice = choice_of(choices, found_blocks[i].pair);
        float b[6];
        for (int k = 0; k < 3; ++k) {
            b[k] = pair->bounds[k] - margin;
            b[3 + k] = pair->bounds[3 + k] + margin;
        }
        MovingLanes edges;
        place_sources(&edges, vertices, pair, block, first);
        if (next) {
            const uint p = found_blocks[i].pair;
            move_sources(&edges, vertices, next + p, thrown ? thrown[p] : 0.0f, block, first);
        }
        const float far = ahead ? ahead[found_blocks[i].pair] : 0.0f;
        int found[VERTICES_AT_ONCE], asked[VERTICES_AT_ONCE];
        float gap[VERTICES_AT_ONCE], own[VERTICES_AT_ONCE];
        FOR_LANES(k, VERTICES_AT_ONCE) {
            own[k] = block->exit[first + k] < choice.least_ahead ? margin - choice.ahead : margin;
        }
        FOR_LANES(k, VERTICES_AT_ONCE) {
            const float x = edges.middle[0][k], y = edges.middle[1][k], z = edges.middle[2][k];
            const float ex = edges.reach[0][k], ey = edges.reach[1][k], ez = edges.reach[2][k];
            const uint inside = (x + ex >= b[0]) & (x - ex <= b[3]) & (y + ey >= b[1]) & (y - ey <= b[4])
                                & (z + ez >= b[2]) & (z - ez <= b[5]);
            // Those that come into the bounds later may be as near as these.
            gap[k] = bounds_gap(b, x, y, z) - (1.0005f * edges.length[k] + edges.away[k]);
            found[k] = -(int)inside;
            asked[k] = -(int)((uint)(block->vertex[first + k] != NONE) & (uint)(gap[k] < far) & (uint)(far > 0.0f));
        }
        const uint asks_far = pack_vertices(asked);
        if ((pack_vertices(found) | asks_far) == 0u) continue;
        READS(ShapeHeader) target = shapes + pair->target;
        const Clearance grid = clearance_of(target);
        READS(uint) balls = AT(memory, uint, target->clearances);
        float beyond[VERTICES_AT_ONCE];
        FOR_LANES(k, VERTICES_AT_ONCE) {
            const float x = edges.middle[0][k], y = edges.middle[1][k], z = edges.middle[2][k];
            const float qx = 0.5f * edges.half_edge[0][k], qy = 0.5f * edges.half_edge[1][k];
            const float qz = 0.5f * edges.half_edge[2][k];
            const float one = safe_distance(grid, balls, x - qx, y - qy, z - qz, 0.0f);
            const float two = safe_distance(grid, balls, x + qx, y + qy, z + qz, 0.0f);
            beyond[k] = (one < two ? one : two) - ((0.50025f * edges.length[k] + own[k]) + edges.away[k]);
            found[k] &= -(int)(beyond[k] <= 0.0f);
        }
        if (asks_far != 0u) {
            FOR_LANES(k, VERTICES_AT_ONCE) {
                const float free = gap[k] > beyond[k] ? gap[k] : beyond[k];
                beyond[k] = asked[k] != 0 && free < far ? free : far;
            }
            const float steps = least_of_vertices(beyond) / target->tolerance;
            MIN_TO(&found_blocks[i].clear, steps > 0.0f ? (uint)(steps < MOST_CLEAR ? steps : MOST_CLEAR) : 0u);
        }
        const uint lanes = pack_vertices(found);
        ADD_TO(&found_blocks[i].lanes, lanes << first);
        ADD_TO(counts + i, bit_count(lanes));
    }
}

// Edges of a group, one in each lane, target frame.
STRUCT(EdgeGroup) {
    float middle[3][RAYS_IN_GROUP], arm[3][RAYS_IN_GROUP];  // arm: from the middle to an end
    float low[3][RAYS_IN_GROUP], high[3][RAYS_IN_GROUP];    // its box, grown by the margin
    float length[RAYS_IN_GROUP], margin[RAYS_IN_GROUP];     // of the arm; metres
    float way[3][RAYS_IN_GROUP], way_length[RAYS_IN_GROUP]; // from here, half-way to the next step, there and back
    uint pair[RAYS_IN_GROUP];
};

// What casting edges reads, and where faces found go: the number and the first few of each edge; or, if that is not
// null, those of a single edge to `near`, all of them.
STRUCT(EdgeArrays) {
    uint vertices; // 1: the sources are points
    READS(DirectedPair) pairs;
    READS(DirectedPair) next;  // null: the pairs stay; else they are half-way there
    READS(float) thrown;       // by pair, as of find_margins
    READS(float) margins;      // by pair
    READS(EdgeChoice) choices; // by pair; null: all edges alike
    READS(ShapeHeader) shapes;
    READS(ulong) memory;
    READS(Ray) rays;
    WRITES(EdgeHits) hits;
    WRITES(NearEdge) near;
};

#define EDGE_ROUNDING 1.0e-6f // of a product of lengths: several times what volumes lose

// Triangles of a block whose boxes reach into that of edge r.
DEVICE uint triangles_in(const EdgeGroup* group, uint r, READS(TriangleBlock) block) {
    const float low_x = group->low[0][r], low_y = group->low[1][r], low_z = group->low[2][r];
    const float high_x = group->high[0][r], high_y = group->high[1][r], high_z = group->high[2][r];
    int within[TRIANGLE_LANES];
    FOR_LANES(k, TRIANGLE_LANES) {
        const float ax = block->corner[0][k], ay = block->corner[1][k], az = block->corner[2][k];
        const float bx = block->corner[3][k], by = block->corner[4][k], bz = block->corner[5][k];
        const float cx = block->corner[6][k], cy = block->corner[7][k], cz = block->corner[8][k];
        const uint above = ((ax >= low_x) | (bx >= low_x) | (cx >= low_x))
                           & ((ay >= low_y) | (by >= low_y) | (cy >= low_y))
                           & ((az >= low_z) | (bz >= low_z) | (cz >= low_z));
        const uint below = ((ax <= high_x) | (bx <= high_x) | (cx <= high_x))
                           & ((ay <= high_y) | (by <= high_y) | (cy <= high_y))
                           & ((az <= high_z) | (bz <= high_z) | (cz <= high_z));
        within[k] = -(int)(above & below);
    }
    return pack_sixteen(within);
}

// Of some triangles of a block those to which edge r comes within its margin, and some others close to it: its ends are
// not both farther on one side of the plane, and its line does not pass the triangle farther outside. A volume of two
// edges is at most the product of their lengths times their distance. Of an edge on its way: the same for all that it
// passes, and the triangle reaches the plane in which its middle moves along.
DEVICE uint triangles_near(const EdgeGroup* group, uint r, READS(TriangleBlock) block, uint some) {
    const float mx = group->middle[0][r], my = group->middle[1][r], mz = group->middle[2][r];
    const float hx = group->arm[0][r], hy = group->arm[1][r], hz = group->arm[2][r];
    const float length = group->length[r], margin = group->margin[r];
    const float wx = group->way[0][r], wy = group->way[1][r], wz = group->way[2][r], way = group->way_length[r];
    const float sx = wy * hz - wz * hy, sy = wz * hx - wx * hz, sz = wx * hy - wy * hx;
    const float side_margin = margin * root_of((sx * sx + sy * sy) + sz * sz);
    int near[TRIANGLE_LANES] = {0};
    // A GPU's thread tests one after the other, and only those asked for.
    FOR_LANES(k, TRIANGLE_LANES) {
        if (RAYS_IN_GROUP == 1 && ((some >> k) & 1u) == 0u) continue;
        // To the first corner; from there to the second and to the third.
        const float ax = block->corner[0][k] - mx, ay = block->corner[1][k] - my, az = block->corner[2][k] - mz;
        const float px = block->corner[3][k] - block->corner[0][k], py = block->corner[4][k] - block->corner[1][k];
        const float pz = block->corner[5][k] - block->corner[2][k];
        const float qx = block->corner[6][k] - block->corner[0][k], qy = block->corner[7][k] - block->corner[1][k];
        const float qz = block->corner[8][k] - block->corner[2][k];
        const float longest = root_of((px * px + py * py) + pz * pz) + root_of((qx * qx + qy * qy) + qz * qz);
        const float size = (magnitude_of(ax) + magnitude_of(ay)) + magnitude_of(az);
        const float nx = py * qz - pz * qy, ny = pz * qx - px * qz, nz = px * qy - py * qx;
        const float height = magnitude_of((nx * ax + ny * ay) + nz * az);
        const float along = (nx * hx + ny * hy) + nz * hz;
        const float plane_margin =
            margin * root_of((nx * nx + ny * ny) + nz * nz) + EDGE_ROUNDING * (longest * longest) * (size + length);
        const float rise = magnitude_of((nx * wx + ny * wy) + nz * wz);
        const uint meets_plane = (uint)(height <= (magnitude_of(along) + rise) + plane_margin);
        const float cx = hy * az - hz * ay, cy = hz * ax - hx * az, cz = hx * ay - hy * ax;
        const float w = (px * cx + py * cy) + pz * cz;
        const float v = -((qx * cx + qy * cy) + qz * cz);
        const float u = (along - v) - w;
        const float off = (length * longest) * ((margin + way) + EDGE_ROUNDING * (size + longest));
        const uint outwards = (u >= -off) & (v >= -off) & (w >= -off), inwards = (u <= off) & (v <= off) & (w <= off);
        const float one = (sx * ax + sy * ay) + sz * az;
        const float two = one + ((sx * px + sy * py) + sz * pz), three = one + ((sx * qx + sy * qy) + sz * qz);
        const float aside = side_margin + EDGE_ROUNDING * (way * length) * (size + longest);
        const uint left = (one > aside) & (two > aside) & (three > aside);
        const uint right = (one < -aside) & (two < -aside) & (three < -aside);
        near[k] = -(int)((meets_plane & (outwards | inwards)) & ~(left | right) & 1u);
    }
    return pack_sixteen(near) & some;
}

// A bit for each edge of a group whose box meets that of a node's lane.
DEVICE uint edges_in_lane(const EdgeGroup* group, READS(Node) node, uint lane) {
    const float low_x = node->bounds[0][lane], low_y = node->bounds[1][lane], low_z = node->bounds[2][lane];
    const float high_x = node->bounds[3][lane], high_y = node->bounds[4][lane], high_z = node->bounds[5][lane];
    int near[NODE_LANES] = {0};
    FOR_LANES(r, RAYS_IN_GROUP) {
        const uint x = (group->low[0][r] <= high_x) & (group->high[0][r] >= low_x);
        const uint y = (group->low[1][r] <= high_y) & (group->high[1][r] >= low_y);
        const uint z = (group->low[2][r] <= high_z) & (group->high[2][r] >= low_z);
        near[r] = -(int)(x & y & z);
    }
    return RAYS_IN_GROUP > 1 ? pack_sixteen(near) : (uint)near[0] & 1u;
}

DEVICE void add_edge(EdgeGroup* group, uint r, const EdgeArrays* arrays, const Ray ray) {
    SourceRay edge = source_ray(arrays->pairs + ray.pair, arrays->shapes, arrays->memory, ray.vertex_lane);
    const float hides = edge.reach; // of vertices how far they go until they leave their body
    float farther = 0.0f;
    if (arrays->thrown && edge.reach < arrays->thrown[ray.pair]) farther = arrays->thrown[ray.pair];
    float way2 = 0.0f, turn2 = 0.0f, passed[3] = {0.0f, 0.0f, 0.0f};
    for (int i = 0; i < 3; ++i) {
        group->way[i][r] = 0.0f;
        if (arrays->vertices != 0u) edge.direction[i] = 0.0f;
    }
    float length2 = 0.0f;
    for (int i = 0; i < 3; ++i) length2 += edge.direction[i] * edge.direction[i];
    if (arrays->next) {
        const SourceRay then = source_ray(arrays->next + ray.pair, arrays->shapes, arrays->memory, ray.vertex_lane);
        for (int i = 0; i < 3; ++i) {
            const float way = then.position[i] - edge.position[i], turn = then.direction[i] - edge.direction[i];
            way2 += way * way;
            if (arrays->vertices != 0u) {
                edge.direction[i] = way;
                continue;
            }
            group->way[i][r] = way;
            passed[i] = magnitude_of(way) + magnitude_of(turn);
            turn2 += turn * turn;
        }
    }
    const EdgeChoice choice = choice_of(arrays->choices, ray.pair);
    const float margin = (arrays->margins[ray.pair] - (hides < choice.least_ahead ? choice.ahead : 0.0f)) + farther;
    const float way = 1.0001f * root_of(way2);
    for (int i = 0; i < 3; ++i) {
        const float reach = (magnitude_of(edge.direction[i]) + passed[i]) + margin;
        group->middle[i][r] = edge.position[i];
        group->arm[i][r] = edge.direction[i];
        group->low[i][r] = edge.position[i] - reach;
        group->high[i][r] = edge.position[i] + reach;
    }
    group->length[r] = arrays->vertices != 0u ? way : 1.0005f * root_of(length2);
    group->margin[r] = margin + 1.0001f * root_of(turn2);
    group->way_length[r] = arrays->vertices != 0u ? 0.0f : way;
    group->pair[r] = ray.pair;
}

// The box around edges `own` of a group, a bit each.
DEVICE void box_of_edges(float* box, const EdgeGroup* group, uint own) {
    for (int i = 0; i < 3; ++i) {
        float low = UNBOUNDED, high = -UNBOUNDED;
        for (uint left = own; left != 0u; left &= left - 1u) {
            const uint r = lowest_bit(left);
            low = group->low[i][r] < low ? group->low[i][r] : low;
            high = group->high[i][r] > high ? group->high[i][r] : high;
        }
        box[i] = low;
        box[3 + i] = high;
    }
}

// Casts edges of one pair, a bit each in `own`; first: index of the group's first. Their faces come in the order of the
// tree, whatever other edges are cast beside.
DEVICE void cast_together(const EdgeArrays* arrays, const EdgeGroup* group, uint own, uint first) {
    READS(ShapeHeader) shape = arrays->shapes + arrays->pairs[group->pair[lowest_bit(own)]].target;
    READS(Node) tree = AT(arrays->memory, Node, shape->nodes);
    READS(TriangleBlock) blocks = AT(arrays->memory, TriangleBlock, shape->triangle_blocks);
    float box[6];
    box_of_edges(box, group, own);
    uint written = 0u;
    Descent way = {0u, 0u, lanes_in(box, tree->bounds)};
    for (;;) {
        while (way.children != 0u) {
            const uint leaf_lane = lowest_bit(way.children);
            const uint child = next_child(&way, tree);
            if ((child & LEAF) == 0u) {
                go_down(&way, child, lanes_in(box, tree[child].bounds));
                continue;
            }
            READS(TriangleBlock) block = blocks + (child & ~LEAF);
            for (uint edges = edges_in_lane(group, tree + way.at, leaf_lane) & own; edges != 0u; edges &= edges - 1u) {
                const uint r = lowest_bit(edges), boxed = triangles_in(group, r, block);
                uint lanes = boxed != 0u ? triangles_near(group, r, block, boxed) : 0u;
                for (; lanes != 0u; lanes &= lanes - 1u) {
                    const uint triangle = block->triangle[lowest_bit(lanes)];
                    if (arrays->near) {
                        arrays->near[written].face = triangle;
                        ++written;
                        continue;
                    }
                    WRITES(EdgeHits) edge = arrays->hits + first + r;
                    if (edge->count < EDGE_FACES) edge->face[edge->count] = triangle;
                    ++edge->count;
                }
            }
        }
        if (way.at == 0u) return;
        go_up(&way, tree);
    }
}

KERNEL void cast_edges(COUNT(count), uint vertices, READS(DirectedPair) pairs, READS(DirectedPair) next,
                       READS(float) thrown, READS(float) margins, READS(EdgeChoice) choices, READS(ShapeHeader) shapes,
                       READS(ulong) memory, READS(Ray) rays, WRITES(EdgeHits) hits, WRITES(uint) counts) {
    // NOLINTNEXTLINE(modernize-use-nullptr): this text is C as well
    const EdgeArrays arrays = {vertices,           pairs, next, thrown, margins, choices, shapes, memory, rays, hits,
                               (GLOBAL NearEdge*)0};
    FOR_EACH_FEW(i, few, RAYS_IN_GROUP, count) {
        EdgeGroup group;
        for (uint r = 0u; r < RAYS_IN_GROUP; ++r) add_edge(&group, r, &arrays, rays[r < few ? i + r : i]);
        for (uint r = 0u; r < few; ++r) {
            hits[i + r].count = 0u;
            // NOLINTNEXTLINE(modernize-loop-convert): this text is C as well
            for (uint k = 0u; k < EDGE_FACES; ++k) hits[i + r].face[k] = NONE;
        }
        for (uint r = 0u, same = 1u; r < few; r += same, same = 1u) {
            while (r + same < few && group.pair[r + same] == group.pair[r]) ++same;
            cast_together(&arrays, &group, ((1u << same) - 1u) << r, i);
        }
        for (uint r = 0u; r < few; ++r) counts[i + r] = hits[i + r].count;
    }
}

// Edges with more faces than EdgeHits holds are cast again.
KERNEL void write_edges(COUNT(count), uint vertices, READS(DirectedPair) pairs, READS(DirectedPair) next,
                        READS(float) thrown, READS(float) margins, READS(EdgeChoice) choices, READS(ShapeHeader) shapes,
                        READS(ulong) memory, READS(Ray) rays, READS(EdgeHits) hits, READS(uint) firsts,
                        WRITES(NearEdge) near) {
    FOR_EACH(i, count) {
        const uint found = hits[i].count;
        if (found == 0u) continue;
        const Ray ray = rays[i];
        const uint edge = source_block(pairs + ray.pair, shapes, memory, ray.vertex_lane / VERTEX_LANES)
                              ->vertex[ray.vertex_lane % VERTEX_LANES];
        if (found > EDGE_FACES) {
            // NOLINTNEXTLINE(modernize-use-nullptr): this text is C as well
            GLOBAL EdgeHits* none = (GLOBAL EdgeHits*)0;
            const EdgeArrays arrays = {vertices, pairs,  next, thrown, margins,         choices,
                                       shapes,   memory, rays, none,   near + firsts[i]};
            EdgeGroup group;
            for (uint r = 0u; r < RAYS_IN_GROUP; ++r) add_edge(&group, r, &arrays, ray);
            cast_together(&arrays, &group, 1u, i);
        }
        for (uint k = 0u; k < found; ++k) {
            WRITES(NearEdge) own = near + firsts[i] + k;
            if (found <= EDGE_FACES) own->face = hits[i].face[k];
            own->edge = edge;
            own->pair = ray.pair;
        }
    }
}
