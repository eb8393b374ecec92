// SPDX-License-Identifier: Apache-2.0
// Turns the poses of bodies in the world into the pose of each source in its target's frame: relative_pose() in double,
// rounded only then, so that nothing is lost far from the origin. Only these kernels use double.

// Bodies that moved, then pairs that came or went.
KERNEL void apply_changes(COUNT(count), uint moved_count, READS(BodyPlace) moved, READS(PairChange) changed,
                          WRITES(BodyPlace) bodies, WRITES(PairBodies) pairs) {
    FOR_EACH(i, count) {
        if (i < moved_count)
            bodies[moved[i].slot] = moved[i];
        else
            pairs[changed[i - moved_count].slot] = changed[i - moved_count].bodies;
    }
}

// The operations of relative_pose(target, source), in their order. An open mesh has no inside that its box could bound:
// vertices beyond the box may still reach it.
DEVICE void place_pair(READS(BodyPlace) source, READS(BodyPlace) target, READS(ShapeHeader) shapes,
                       WRITES(DirectedPair) placed) {
    READS(double) o = target->rotation;
    READS(double) s = source->rotation;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            placed->rotation[3 * row + column] =
                (float)((o[row] * s[column] + o[3 + row] * s[3 + column]) + o[6 + row] * s[6 + column]);
    const double x = source->translation[0] - target->translation[0];
    const double y = source->translation[1] - target->translation[1];
    const double z = source->translation[2] - target->translation[2];
    for (int row = 0; row < 3; ++row)
        placed->translation[row] = (float)((o[row] * x + o[3 + row] * y) + o[6 + row] * z);
    READS(ShapeHeader) shape = shapes + target->shape;
    const float grow = shape->closed != 0u ? 0.0f : shapes[source->shape].ray_reach;
    for (int k = 0; k < 3; ++k) {
        placed->bounds[k] = shape->low[k] - grow;
        placed->bounds[3 + k] = shape->high[k] + grow;
    }
    placed->source = source->shape;
    placed->target = target->shape;
}

// Slot p becomes placed pairs 2 p (first into second) and 2 p + 1.
KERNEL void place_pairs(COUNT(count), READS(PairBodies) pairs, READS(BodyPlace) bodies, READS(ShapeHeader) shapes,
                        WRITES(DirectedPair) placed) {
    FOR_EACH(p, count) {
        const PairBodies pair = pairs[p];
        if (pair.first == NONE) {
            placed[2u * p].source = NONE;
            placed[2u * p + 1u].source = NONE;
        } else {
            place_pair(bodies + pair.first, bodies + pair.second, shapes, placed + 2u * p);
            place_pair(bodies + pair.second, bodies + pair.first, shapes, placed + 2u * p + 1u);
        }
    }
}
