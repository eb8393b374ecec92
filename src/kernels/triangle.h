// SPDX-License-Identifier: Apache-2.0
// Ray against triangle after Woop, Benthin and Wald 2013: shear so that the ray is the z axis, then three 2D edge
// functions. Two facts make it exact in float32, given the sheared coordinates, which neighbours share:
// rounding is monotone, so fl(a) - fl(b) has the sign of a - b unless it is 0; and product_error() gives what the
// rounding of a product lost, which decides the rest.

STRUCT(RayFrame) {
    float origin[3]; // permuted: x, y, z with z the largest component of the direction
    float shear[3];  // x / z, y / z, 1 / z
    uint axis[3];
    float raw_origin[3];
    float inverse[3]; // 1 / direction, huge instead of infinite
};

// Closest hits so far. Hits beyond `limit` cannot change the outcome.
STRUCT(Closest) {
    float back, front; // distances of the closest face met from inside, from outside
    uint back_triangle;
    float limit;
};

// Huge instead of infinite, with the sign of d.
DEVICE float safe_inverse(float d) {
    const float tiny = 1.0e-20f, least = d < 0.0f ? -tiny : tiny;
    return 1.0f / (magnitude_of(d) < tiny ? least : d);
}

// Axes of a frame: z where the direction is largest; the winding is kept. Found without a branch: directions are as
// good as random, and a misprediction costs more than the computation.
STRUCT(Axes) {
    uint x, y, z;
};

DEVICE uint largest_axis(float x, float y, float z) {
    const float ax = magnitude_of(x), ay = magnitude_of(y), az = magnitude_of(z);
    const float larger = ax > ay ? ax : ay;
    const uint third = (uint) !(larger > az);
    return 2u * third + ((third ^ 1u) & (uint)(ax <= ay));
}

DEVICE Axes axes_of(uint z, float along, const bool mirrored) {
    const uint next = (z + 1u) & (0u - (uint)(z != 2u)), last = 3u - z - next;
    const uint swap = (next ^ last) & (0u - ((uint)(along < 0.0f) ^ (uint)mirrored));
    const Axes axes = {next ^ swap, last ^ swap, z};
    return axes;
}

// opposite: the mirrored frame of the opposite ray, so that each face counts as front or back as it does for the ray.
DEVICE RayFrame frame_ray(const float* p, const float* d, const bool opposite) {
    RayFrame ray;
    const float sign = opposite ? -1.0f : 1.0f, v[3] = {sign * d[0], sign * d[1], sign * d[2]};
    const uint z = largest_axis(v[0], v[1], v[2]);
    const Axes axes = axes_of(z, v[z], opposite);
    ray.axis[0] = axes.x;
    ray.axis[1] = axes.y;
    ray.axis[2] = axes.z;
    for (int i = 0; i < 3; ++i) {
        ray.origin[i] = p[ray.axis[i]];
        ray.raw_origin[i] = p[i];
        ray.inverse[i] = safe_inverse(v[i]);
    }
    ray.shear[2] = ray.inverse[axes.z];
    ray.shear[0] = v[axes.x] * ray.inverse[axes.z];
    ray.shear[1] = v[axes.y] * ray.inverse[axes.z];
    return ray;
}

// a * b - c * d, relative error of a few units in the last place, sign exact.
DEVICE float cross_accurate(float a, float b, float c, float d) {
    const float p = a * b, q = c * d;
    return (p - q) + (product_error(a, b, p) - product_error(c, d, q));
}

// Edge functions of a triangle in a ray's frame: no two have opposite signs if the ray's line passes through it.
STRUCT(Edges) {
    float u, v, w;
};

// From sheared corners.
DEVICE Edges edges_of(float x0, float y0, float x1, float y1, float x2, float y2) {
    const Edges edges = {cross_accurate(x2, y1, y2, x1), cross_accurate(x0, y2, y0, x2),
                         cross_accurate(x1, y0, y1, x0)};
    return edges;
}

DEVICE float area_of(const Edges edges) {
    return (edges.u + edges.v) + edges.w;
}

// With accurate barycentrics, so that the distance found lies in every box that contains the triangle.
DEVICE float distance_of(const Edges edges, float az, float bz, float cz, float shear_z) {
    return ((edges.u * az + edges.v * bz + edges.w * cz) / area_of(edges)) * shear_z;
}

// A face met from outside counts up to `tolerance` behind the origin: the origin may be outside. A back face does not.
DEVICE void accept_hit(Closest* closest, float t, bool back, uint triangle, float tolerance) {
    if (t < (back ? 0.0f : -tolerance) || t > closest->limit) return;
    if (back) {
        if (t < closest->back || (t == closest->back && triangle < closest->back_triangle)) {
            closest->back = t;
            closest->back_triangle = triangle;
        }
    } else if (t < closest->front) {
        closest->front = t;
    }
    const float nearer = closest->back < closest->front ? closest->back : closest->front;
    if (nearer + tolerance < closest->limit) closest->limit = nearer + tolerance;
}

// Corners of a triangle in a ray's frame, sheared.
STRUCT(Corners) {
    float x[3], y[3], z[3];
};

DEVICE Corners corners_of(const RayFrame* ray, READS(TriangleBlock) block, uint lane) {
    Corners at;
    for (int c = 0; c < 3; ++c) {
        at.z[c] = block->corner[3 * c + ray->axis[2]][lane] - ray->origin[2];
        at.x[c] = (block->corner[3 * c + ray->axis[0]][lane] - ray->origin[0]) - ray->shear[0] * at.z[c];
        at.y[c] = (block->corner[3 * c + ray->axis[1]][lane] - ray->origin[1]) - ray->shear[1] * at.z[c];
    }
    return at;
}

// Tests one lane exactly.
DEVICE void hit_lane(Closest* closest, const RayFrame* ray, READS(TriangleBlock) block, uint lane, float tolerance,
                     const bool by_distance) {
    const Corners at = corners_of(ray, block, lane);
    const float* z = at.z;
    if (!by_distance) {
        const float t0 = z[0] * ray->shear[2], t1 = z[1] * ray->shear[2], t2 = z[2] * ray->shear[2];
        const float beyond = closest->limit + tolerance, behind = -2.0f * tolerance;
        if ((t0 > beyond && t1 > beyond && t2 > beyond) || (t0 < behind && t1 < behind && t2 < behind)) return;
    }
    const Edges e = edges_of(at.x[0], at.y[0], at.x[1], at.y[1], at.x[2], at.y[2]);
    const bool front = e.u >= 0.0f && e.v >= 0.0f && e.w >= 0.0f, back = e.u <= 0.0f && e.v <= 0.0f && e.w <= 0.0f;
    if (!(front || back) || area_of(e) == 0.0f) return; // edge-on: the neighbours take the hit
    accept_hit(closest, distance_of(e, z[0], z[1], z[2], ray->shear[2]), back, block->triangle[lane], tolerance);
}

// Tests sixteen triangles at once: the ray's line may pass through those whose edge functions do not have both signs;
// two products and one minimum decide. If a product is 0 or underflows, the lane passes and hit_lane() decides.
// by_distance: also rejects lanes whose corners are all behind the ray, or all too far, by more than rounding could
// hide (a hit is a mean of its corners). That pays if the block is near; if every block is tested, few lanes get so
// far.
DEVICE uint hit_block(const Closest* closest, const RayFrame* ray, READS(TriangleBlock) block, float tolerance,
                      const bool by_distance) {
    READS(float) ax = (block->corner + ray->axis[0])[0];
    READS(float) ay = (block->corner + ray->axis[1])[0];
    READS(float) az = (block->corner + ray->axis[2])[0];
    READS(float) bx = (block->corner + ray->axis[0])[3];
    READS(float) by = (block->corner + ray->axis[1])[3];
    READS(float) bz = (block->corner + ray->axis[2])[3];
    READS(float) cx = (block->corner + ray->axis[0])[6];
    READS(float) cy = (block->corner + ray->axis[1])[6];
    READS(float) cz = (block->corner + ray->axis[2])[6];
    const float ox = ray->origin[0], oy = ray->origin[1], oz = ray->origin[2];
    const float sx = ray->shear[0], sy = ray->shear[1], sz = ray->shear[2];
    int hit[TRIANGLE_LANES];
    FOR_LANES(k, TRIANGLE_LANES) {
        const float z0 = az[k] - oz, z1 = bz[k] - oz, z2 = cz[k] - oz;
        const float x0 = (ax[k] - ox) - sx * z0, y0 = (ay[k] - oy) - sy * z0;
        const float x1 = (bx[k] - ox) - sx * z1, y1 = (by[k] - oy) - sy * z1;
        const float x2 = (cx[k] - ox) - sx * z2, y2 = (cy[k] - oy) - sy * z2;
        const float u = x2 * y1 - y2 * x1;
        const float v = x0 * y2 - y0 * x2;
        const float w = x1 * y0 - y1 * x0;
        const float uv = u * v, uw = u * w;
        const uint inside = (uv < uw ? uv : uw) >= 0.0f;
        uint reached = 1u;
        if (by_distance) {
            const float t0 = z0 * sz, t1 = z1 * sz, t2 = z2 * sz;
            const float first_01 = t0 < t1 ? t0 : t1, last_01 = t0 > t1 ? t0 : t1;
            const float first = first_01 < t2 ? first_01 : t2, last = last_01 > t2 ? last_01 : t2;
            reached = (first <= closest->limit + tolerance) & (last >= -2.0f * tolerance);
        }
        hit[k] = -(int)(inside & reached);
    }
    return pack_sixteen(hit);
}
