// SPDX-License-Identifier: Apache-2.0
// Rays are collected into groups, one in each lane, to be framed and cast together. On a GPU a group is one ray.

#define ENDLESS_TOLERANCES 65536.0f // how far a group follows a ray without end: a sixteenth of the box diagonal

// A ray in each lane, with the members of its RayFrame.
STRUCT(RayGroup) {
    float position[3][RAYS_IN_GROUP], direction[3][RAYS_IN_GROUP]; // target frame
    float origin[3][RAYS_IN_GROUP], shear[3][RAYS_IN_GROUP], inverse[3][RAYS_IN_GROUP];
    uint axis[3][RAYS_IN_GROUP];
    float reach[RAYS_IN_GROUP];
    float length[RAYS_IN_GROUP], tolerance[RAYS_IN_GROUP]; // metres; the group is cast no farther than `length`
    uint pair[RAYS_IN_GROUP];
    READS(ShapeHeader) shape[RAYS_IN_GROUP]; // the target's
    uint at[RAYS_IN_GROUP];                  // index of the ray
    uint count;
};

// Sets all lanes, since lanes without a ray are framed, too.
DEVICE void clear_group(RayGroup* group) {
    group->count = 0u;
    for (int i = 0; i < 3; ++i) FOR_LANES(r, RAYS_IN_GROUP) group->position[i][r] = group->direction[i][r] = 0.0f;
    FOR_LANES(r, RAYS_IN_GROUP) group->length[r] = group->tolerance[r] = 0.0f;
}

// at: index of the ray.
DEVICE void add_ray(RayGroup* group, uint at, const SourceRay* ray, float reach, uint pair, READS(ShapeHeader) shape) {
    const uint r = group->count;
    for (int i = 0; i < 3; ++i) {
        group->position[i][r] = ray->position[i];
        group->direction[i][r] = ray->direction[i];
    }
    group->reach[r] = reach;
    group->length[r] = reach < UNBOUNDED ? reach : ENDLESS_TOLERANCES * shape->tolerance;
    group->tolerance[r] = shape->tolerance;
    group->pair[r] = pair;
    group->shape[r] = shape;
    group->at[r] = at;
    group->count = r + 1u;
}

DEVICE bool is_full(const RayGroup* group) {
    return group->count == RAYS_IN_GROUP;
}

DEVICE SourceRay ray_of(const RayGroup* group, uint r) {
    SourceRay ray;
    for (int i = 0; i < 3; ++i) {
        ray.position[i] = group->position[i][r];
        ray.direction[i] = group->direction[i][r];
    }
    ray.reach = group->reach[r];
    return ray;
}

// frame_ray() for every lane; components are selected, not indexed. opposite: also reverses the directions of the rays.
DEVICE void frame_group(RayGroup* group, const bool opposite) {
    const float sign = opposite ? -1.0f : 1.0f;
    FOR_LANES(r, RAYS_IN_GROUP) {
        const float px = group->position[0][r], py = group->position[1][r], pz = group->position[2][r];
        const float dx = sign * group->direction[0][r], dy = sign * group->direction[1][r];
        const float dz = sign * group->direction[2][r];
        const float ix = safe_inverse(dx), iy = safe_inverse(dy), iz = safe_inverse(dz);
        const uint z = largest_axis(dx, dy, dz);
        const Axes axes = axes_of(z, component(z, dx, dy, dz), opposite);
        const float along = component(z, ix, iy, iz);
        group->direction[0][r] = dx;
        group->direction[1][r] = dy;
        group->direction[2][r] = dz;
        group->origin[0][r] = component(axes.x, px, py, pz);
        group->origin[1][r] = component(axes.y, px, py, pz);
        group->origin[2][r] = component(axes.z, px, py, pz);
        group->shear[0][r] = component(axes.x, dx, dy, dz) * along;
        group->shear[1][r] = component(axes.y, dx, dy, dz) * along;
        group->shear[2][r] = along;
        group->inverse[0][r] = ix;
        group->inverse[1][r] = iy;
        group->inverse[2][r] = iz;
        group->axis[0][r] = axes.x;
        group->axis[1][r] = axes.y;
        group->axis[2][r] = axes.z;
    }
}

DEVICE RayFrame frame_of(const RayGroup* group, uint r) {
    RayFrame frame;
    for (int i = 0; i < 3; ++i) {
        frame.origin[i] = group->origin[i][r];
        frame.shear[i] = group->shear[i][r];
        frame.axis[i] = group->axis[i][r];
        frame.raw_origin[i] = group->position[i][r];
        frame.inverse[i] = group->inverse[i][r];
    }
    return frame;
}
