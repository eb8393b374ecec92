// SPDX-License-Identifier: Apache-2.0
// How far points can move before they could be in contact. A clearance grid stores for each cell a ball that contains
// no surface (docs/internals/certified.md).

// A clearance grid, without its balls.
STRUCT(Clearance) {
    float low[3], high[3]; // a box around that of the shape
    float scale, cell, unit;
    uint size_x, size_y;
    uint outward;
};

DEVICE Clearance clearance_of(READS(ShapeHeader) shape) {
    Clearance grid;
    for (int i = 0; i < 3; ++i) {
        grid.low[i] = shape->clearance_low[i];
        grid.high[i] = shape->clearance_high[i];
    }
    grid.scale = shape->clearance_scale;
    grid.cell = shape->clearance_cell;
    grid.unit = shape->clearance_unit;
    grid.size_x = shape->clearance_size[0];
    grid.size_y = shape->clearance_size[1];
    grid.outward = shape->outward;
    return grid;
}

// A lower bound of how far a point can move before it could be in contact. Outside a closed mesh: its distance from the
// surface. Elsewhere: that distance less `reach`, since its ray goes no farther. May be negative.
DEVICE float safe_distance(const Clearance grid, READS(uint) balls, float x, float y, float z, float reach) {
    // The nearest point of the grid's box, and its cell; for NaN the box's lower corner.
    const float up_x = x >= grid.low[0] ? x : grid.low[0], up_y = y >= grid.low[1] ? y : grid.low[1];
    const float up_z = z >= grid.low[2] ? z : grid.low[2];
    const float px = up_x <= grid.high[0] ? up_x : grid.high[0], py = up_y <= grid.high[1] ? up_y : grid.high[1];
    const float pz = up_z <= grid.high[2] ? up_z : grid.high[2];
    const int cell_x = (int)((px - grid.low[0]) * grid.scale), cell_y = (int)((py - grid.low[1]) * grid.scale);
    const int cell_z = (int)((pz - grid.low[2]) * grid.scale);
    const uint word = balls[((uint)cell_z * grid.size_y + (uint)cell_y) * grid.size_x + (uint)cell_x];
    const float off_x = x - px, off_y = y - py, off_z = z - pz;
    const float off2 = (off_x * off_x + off_y * off_y) + off_z * off_z;
    const int bx = cell_x + (int)(word & 31u) - CLEARANCE_OFFSET;
    const int by = cell_y + (int)((word >> 5) & 31u) - CLEARANCE_OFFSET;
    const int bz = cell_z + (int)((word >> 10) & 31u) - CLEARANCE_OFFSET;
    const float ax = px - (grid.low[0] + ((float)bx + 0.5f) * grid.cell);
    const float ay = py - (grid.low[1] + ((float)by + 0.5f) * grid.cell);
    const float az = pz - (grid.low[2] + ((float)bz + 0.5f) * grid.cell);
    const float ball = (float)(int)(word >> 16) * grid.unit - root_of((ax * ax + ay * ay) + az * az);
    const float clear = ball > 0.0f ? ball : 0.0f;
    // The box is convex, so Pythagoras gives a lower bound for a point outside it.
    const float away = root_of(off2 + clear * clear);
    const uint outside =
        (grid.outward & (uint)(off2 > 0.0f)) | ((uint)(ball > 0.0f) & (uint)((word & CLEARANCE_OUTSIDE) != 0u));
    // Each body's rotation is rigid only to 1e-4, so it may stretch the ray.
    return away - (outside != 0u ? 0.0f : 1.0005f * reach);
}

// A lower bound of a point's distance from the bounds; negative inside. The point casts no ray before it reaches them.
DEVICE float bounds_gap(const float* b, float x, float y, float z) {
    const float gap_x = b[0] - x > x - b[3] ? b[0] - x : x - b[3];
    const float gap_y = b[1] - y > y - b[4] ? b[1] - y : y - b[4];
    const float gap_z = b[2] - z > z - b[5] ? b[2] - z : z - b[5];
    const float gap_xy = gap_x > gap_y ? gap_x : gap_y;
    return gap_xy > gap_z ? gap_xy : gap_z;
}

// safe: metres that each vertex from `first` on can move before it could be in contact; may be negative.
DEVICE void safe_lanes(float* safe, const InsideLanes* placed, READS(DirectedPair) pair, READS(VertexBlock) block,
                       uint first, READS(ShapeHeader) target, READS(ulong) memory) {
    float b[6];
    for (int i = 0; i < 6; ++i) b[i] = pair->bounds[i];
    const Clearance grid = clearance_of(target);
    READS(uint) balls = AT(memory, uint, target->clearances);
    FOR_LANES(k, VERTICES_AT_ONCE) {
        const float x = placed->x[k], y = placed->y[k], z = placed->z[k];
        const float clear = safe_distance(grid, balls, x, y, z, block->exit[first + k]);
        const float gap = bounds_gap(b, x, y, z);
        const float least = clear > gap ? clear : gap;
        safe[k] = block->vertex[first + k] != NONE ? least : UNBOUNDED;
    }
}

DEVICE float least_of_sixteen(const float* values) {
    float least[8];
    FOR_LANES(k, 8) least[k] = values[k] < values[k + 8] ? values[k] : values[k + 8];
    for (int left = 4; left > 0; left /= 2)
        for (int k = 0; k < left; ++k) least[k] = least[k] < least[k + left] ? least[k] : least[k + left];
    return least[0];
}
