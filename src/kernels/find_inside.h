// SPDX-License-Identifier: Apache-2.0
// Finds the pairs of which a component of the source may lie inside the target (docs/internals/edges.md). In float32,
// with a margin for all that this could hide: the host decides in double what was found.

// Whether the target's bounds can hold a component as a whole.
DEVICE bool fits_in(const PairBounds* bounds, READS(Component) component) {
    uint fits = 1u;
    for (int i = 0; i < 3; ++i) {
        const float low = bounds->source_centre[i] - bounds->source_half_size[i];
        const float high = bounds->source_centre[i] + bounds->source_half_size[i];
        fits &= (uint)(component->low[i] >= low) & (uint)(component->high[i] <= high);
    }
    return fits != 0u;
}

// Whether a vertex of the source may be inside the target, a closed mesh. balls: of its clearance grid.
DEVICE bool may_be_inside(READS(DirectedPair) pair, READS(ShapeHeader) target, READS(uint) balls, float margin,
                          READS(float) vertex) {
    READS(float) r = pair->rotation;
    float p[3], b[6];
    for (int i = 0; i < 6; ++i) b[i] = pair->bounds[i];
    for (int i = 0; i < 3; ++i)
        p[i] = ((r[3 * i] * vertex[0] + r[3 * i + 1] * vertex[1]) + r[3 * i + 2] * vertex[2]) + pair->translation[i];
    if (bounds_gap(b, p[0], p[1], p[2]) > margin) return false;
    // A reach without end: only a ball outside gives a bound.
    return target->outward == 0u || !(safe_distance(clearance_of(target), balls, p[0], p[1], p[2], UNBOUNDED) > margin);
}

// 1 or 0. Where the surfaces do not cross, a component inside an outward mesh is inside its bounds as a whole.
DEVICE uint has_part_inside(READS(DirectedPair) pair, READS(ShapeHeader) shapes, READS(ulong) memory) {
    if (pair->source == NONE || shapes[pair->target].closed == 0u) return 0u;
    READS(ShapeHeader) source = shapes + pair->source;
    READS(ShapeHeader) target = shapes + pair->target;
    READS(Component) components = AT(memory, Component, source->components);
    READS(uint) balls = AT(memory, uint, target->clearances);
    const PairBounds bounds = bounds_of(pair);
    const float margin = placed_within(pair, shapes);
    for (uint c = 0u; c < source->component_count; ++c) {
        if (target->outward != 0u && !fits_in(&bounds, components + c)) continue;
        if (may_be_inside(pair, target, balls, margin, components[c].vertex)) return 1u;
    }
    return 0u;
}

KERNEL void count_inside(COUNT(count), READS(DirectedPair) pairs, READS(ShapeHeader) shapes, READS(ulong) memory,
                         WRITES(uint) counts) {
    FOR_EACH(p, count) counts[p] = has_part_inside(pairs + p, shapes, memory);
}

KERNEL void write_inside(COUNT(count), READS(uint) counts, READS(uint) firsts, WRITES(uint) found) {
    FOR_EACH(p, count)
    if (counts[p] != 0u) found[firsts[p]] = p;
}
