// SPDX-License-Identifier: Apache-2.0
// Caps (docs/certified.md): of each triangle of a closed, outward mesh, the balls around its centre in which all
// normals are within an angle of its own. A ray from there along them can only leave the mesh, and once at most,
// however many triangles there are.

#define CAP_UNIT_TOLERANCES 2.0f // a step of the stored radii
// The two angles: 30 and 55 degrees.
#define CAP_NARROW_COSINE 0.8660254f
#define CAP_NARROW_SINE 0.5f
#define CAP_WIDE_COSINE 0.5735764f
#define CAP_WIDE_SINE 0.8191520f
#define CAP_LEAST_FACING 0.125f  // cosine of ray and normal, below which nothing is said
#define CAP_LOST_OF_FACING 0.01f // by rounding of the triangle's normal and of the ray's direction

// No more than the least cosine of a ray's direction and a normal in the triangle's cap; -1: the ray does not begin
// there. far2: squared distance of its origin from the triangle's centre; along: cosine of direction and the triangle's
// own normal; margin: metres of rounding.
DEVICE float facing_in_cap(uint cap, float tolerance, float margin, float far2, float along) {
    const float unit = CAP_UNIT_TOLERANCES * tolerance;
    const float narrow = (float)(int)(cap & 0xffffu) * unit - margin, wide = (float)(int)(cap >> 16) * unit - margin;
    const float across2 = 1.0f - along * along, across = root_of(across2 > 0.0f ? across2 : 0.0f);
    const float in_narrow = (CAP_NARROW_COSINE * along - CAP_NARROW_SINE * across) - CAP_LOST_OF_FACING;
    const float in_wide = (CAP_WIDE_COSINE * along - CAP_WIDE_SINE * across) - CAP_LOST_OF_FACING;
    // The narrow ball lies in the wide one.
    const uint is_in_wide = (uint)(wide > 0.0f) & (uint)(far2 < wide * wide);
    const uint is_in_narrow = (uint)(narrow > 0.0f) & (uint)(far2 < narrow * narrow);
    return component(2u - is_in_wide - is_in_narrow, in_narrow, in_wide, -1.0f);
}

// Whether its cap will know a ray by the triangle that it met, while it meets it.
DEVICE bool is_in_cap(const SourceRay* ray, float facing, float margin, READS(ShapeHeader) shape,
                      READS(TriangleBlock) blocks, uint slot) {
    READS(TriangleBlock) block = blocks + shape->triangle_block_first + slot / TRIANGLE_LANES;
    const uint lane = slot % TRIANGLE_LANES;
    float far2 = 0.0f;
    for (int i = 0; i < 3; ++i) {
        const float middle = (block->corner[i][lane] + block->corner[3 + i][lane]) + block->corner[6 + i][lane];
        const float off = middle * (1.0f / 3.0f) - ray->position[i];
        far2 += off * off;
    }
    return facing_in_cap(block->cap[lane], shape->tolerance, margin, far2, facing) >= CAP_LEAST_FACING;
}
