// SPDX-License-Identifier: Apache-2.0
// The broad phase: boxes of bodies, a tree over them along a curve, and the pairs that touch. Boxes are in double, as
// the host has them, so that the pairs are the same ones.

#define PAIR_LEVELS 5u   // of the tree; sixteen bits each of those above the lowest fit into a trail
#define BLOCK_BODIES 64u // that one item tests against a wide body
#define DIGIT_BITS 6u    // of a key, sorted in one pass
#define DIGITS (1u << DIGIT_BITS)
#define BLOCK_KEYS 64u    // that one item counts and moves, one after the other
#define KEY_BITS 10u      // an axis
#define OUTERMOST 2.9e38f // nearer than the boxes of empty lanes, rounding included

KERNEL void set_extents(COUNT(count), READS(BodyExtent) changed, WRITES(BodyExtent) extents) {
    FOR_EACH(i, count) extents[changed[i].slot] = changed[i];
}

DEVICE double magnitude_in_double(double x) {
    return x > 0.0 ? x : 0.0 - x;
}

// The operations of world_box(), in their order.
DEVICE void box_of_pose(READS(BodyPlace) place, READS(BodyExtent) extent, WRITES(WorldBox) box, uint adds) {
    READS(double) m = extent->middle;
    READS(double) h = extent->half_size;
    double centre[3];
    for (int row = 0; row < 3; ++row) {
        READS(double) r = place->rotation + 3 * row;
        centre[row] = ((r[0] * m[0] + r[1] * m[1]) + r[2] * m[2]) + place->translation[row];
    }
    const double slack =
        1e-9 * (h[0] + h[1] + h[2])
        + 1e-15 * (magnitude_in_double(centre[0]) + magnitude_in_double(centre[1]) + magnitude_in_double(centre[2]));
    for (int row = 0; row < 3; ++row) {
        READS(double) r = place->rotation + 3 * row;
        const double e = magnitude_in_double(r[0]) * h[0] + magnitude_in_double(r[1]) * h[1]
                         + magnitude_in_double(r[2]) * h[2] + slack;
        const double low = centre[row] - e, high = centre[row] + e;
        box->low[row] = adds != 0u && box->low[row] < low ? box->low[row] : low;
        box->high[row] = adds != 0u && box->high[row] > high ? box->high[row] : high;
    }
}

// Of bodies that moved or changed. places: of each, one after the other; its box holds all of them.
KERNEL void make_boxes(COUNT(count), uint places, READS(BodyPlace) moved, READS(BodyExtent) extents,
                       WRITES(WorldBox) boxes) {
    FOR_EACH(i, count) {
        READS(BodyPlace) place = moved + (ulong)places * i;
        READS(BodyExtent) extent = extents + place->slot;
        WRITES(WorldBox) box = boxes + place->slot;
        box->groups = extent->groups;
        box->mask = extent->mask;
        box->moves = (extent->there & IS_STATIC) == 0u ? 1u : 0u;
        if (extent->there != 0u)
            for (uint k = 0u; k < places; ++k) box_of_pose(place + k, extent, box, k);
        else
            for (int k = 0; k < 3; ++k) {
                box->low[k] = UNBOUNDED;
                box->high[k] = -UNBOUNDED;
            }
    }
}

// The tree has its levels one behind the other, the lowest first; sixteen in a row of one have a node of the next. The
// highest has one node, or some where there are more bodies than PAIR_LEVELS levels hold.
DEVICE uint nodes_of(uint slots, uint level) {
    return ((slots - 1u) >> (4u * (level + 1u))) + 1u;
}
DEVICE uint nodes_below(uint slots, uint level) {
    uint nodes = 0u;
    for (uint k = 0u; k < level; ++k) nodes += nodes_of(slots, k);
    return nodes;
}

// Not more than x, or not less. Boxes beyond the range of float meet there.
DEVICE float rounded_down(double x) {
    const float near = (float)(x < OUTERMOST ? x > -OUTERMOST ? x : -OUTERMOST : OUTERMOST);
    return near - (magnitude_of(near) * 1.1920929e-7f + 1.0e-37f);
}
DEVICE float rounded_up(double x) {
    return -rounded_down(-x);
}

// Sixteen boxes in the order of the curve. Empty lanes touch nothing.
DEVICE void fill_leaf(READS(SortKey) order, READS(WorldBox) boxes, uint count, WRITES(BoxNode) node) {
    for (uint lane = 0u; lane < NODE_LANES; ++lane)
        for (int k = 0; k < 3; ++k) {
            const int there = lane < count && boxes[order[lane].slot].low[k] <= boxes[order[lane].slot].high[k];
            node->bounds[k][lane] = there ? rounded_down(boxes[order[lane].slot].low[k]) : UNBOUNDED;
            node->bounds[3 + k][lane] = there ? rounded_up(boxes[order[lane].slot].high[k]) : -UNBOUNDED;
        }
}

// One level: a node an item, of the lowest one from boxes. Each hands its bounds to the node above it, whose lanes
// without a child become empty: so there are sixteen items for each of those.
KERNEL void fill_nodes(COUNT(count), uint level, uint levels, uint slots, READS(SortKey) order, READS(WorldBox) boxes,
                       WRITES(BoxNode) tree) {
    FOR_EACH(i, count) {
        const uint nodes = nodes_of(slots, level);
        WRITES(BoxNode) own = tree + nodes_below(slots, level);
        if (level == 0u && i < nodes) fill_leaf(order + NODE_LANES * i, boxes, slots - NODE_LANES * i, own + i);
        if (level + 1u == levels) continue;
        WRITES(BoxNode) above = own + nodes + i / NODE_LANES;
        for (int k = 0; k < 3; ++k) {
            float low = UNBOUNDED, high = -UNBOUNDED;
            if (i < nodes)
                for (int lane = 0; lane < NODE_LANES; ++lane) {
                    low = own[i].bounds[k][lane] < low ? own[i].bounds[k][lane] : low;
                    high = own[i].bounds[3 + k][lane] > high ? own[i].bounds[3 + k][lane] : high;
                }
            above->bounds[k][i % NODE_LANES] = low;
            above->bounds[3 + k][i % NODE_LANES] = high;
        }
    }
}

// Two zero bits before each of ten.
DEVICE uint spread_bits(uint x) {
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

// A body's place on the curve (Morton 1966): the bits of its coordinates by turns. Slots without a body come last.
KERNEL void make_keys(COUNT(count), uint levels, READS(BoxNode) tree, READS(WorldBox) boxes, WRITES(SortKey) keys) {
    FOR_EACH(i, count) {
        const uint roots = nodes_of(ALL(count), levels - 1u);
        READS(BoxNode) root = tree + nodes_below(ALL(count), levels - 1u);
        float low[3], longest = 0.0f;
        for (int k = 0; k < 3; ++k) {
            float least = UNBOUNDED, most = -UNBOUNDED;
            for (uint r = 0u; r < roots; ++r)
                for (int lane = 0; lane < NODE_LANES; ++lane) {
                    least = root[r].bounds[k][lane] < least ? root[r].bounds[k][lane] : least;
                    most = root[r].bounds[3 + k][lane] > most ? root[r].bounds[3 + k][lane] : most;
                }
            low[k] = least;
            longest = most - least > longest ? most - least : longest;
        }
        const float most_steps = (float)((1u << KEY_BITS) - 1u);
        uint key = 0u;
        for (int k = 0; k < 3; ++k) {
            const float off = (float)(0.5 * (boxes[i].low[k] + boxes[i].high[k]) - low[k]);
            const float steps = off / longest * most_steps;
            // A body so far out that this is no number has any place.
            const float within = steps > 0.0f ? steps < most_steps ? steps : most_steps : 0.0f;
            key = key << 1 | spread_bits((uint)within);
        }
        keys[i].key = boxes[i].low[0] <= boxes[i].high[0] ? key : NONE;
        keys[i].slot = i;
    }
}

// How many of a block's keys have each digit, and all from there on. counts[digit * blocks + block]: their sums place
// the blocks' keys of one digit one behind the other, and those of the next behind them.
KERNEL void count_digits(COUNT(count), uint shift, uint all, READS(SortKey) keys, WRITES(uint) counts) {
    FOR_EACH(i, count) {
        for (uint digit = 0u; digit < DIGITS; ++digit) counts[digit * ALL(count) + i] = 0u;
        for (uint k = BLOCK_KEYS * i; k < all && k < BLOCK_KEYS * (i + 1u); ++k)
            ++counts[(keys[k].key >> shift & (DIGITS - 1u)) * ALL(count) + i];
    }
}

// firsts: becomes where each digit's keys of a block end.
KERNEL void move_keys(COUNT(count), uint shift, uint all, READS(SortKey) keys, WRITES(uint) firsts,
                      WRITES(SortKey) sorted) {
    FOR_EACH(i, count) {
        for (uint k = BLOCK_KEYS * i; k < all && k < BLOCK_KEYS * (i + 1u); ++k) {
            const uint digit = keys[k].key >> shift & (DIGITS - 1u);
            sorted[firsts[digit * ALL(count) + i]++] = keys[k];
        }
    }
}

DEVICE uint are_pair(READS(WorldBox) a, READS(WorldBox) b) {
    const uint x = (a->low[0] <= b->high[0]) & (b->low[0] <= a->high[0]);
    const uint y = (a->low[1] <= b->high[1]) & (b->low[1] <= a->high[1]);
    const uint z = (a->low[2] <= b->high[2]) & (b->low[2] <= a->high[2]);
    const uint meet = ((a->groups & b->mask) != 0u) & ((b->groups & a->mask) != 0u) & ((a->moves | b->moves) != 0u);
    return x & y & z & meet;
}

// A walk down the tree with one box: stackless, as Descent, and without links, since places tell parents and children.
STRUCT(BoxWalk) {
    float box[6];
    ulong trail;
    uint level, first; // of the node; where its level begins
    uint at, children; // its place in the level; the lanes still to visit, a bit each
    uint tests;        // of nodes
};

DEVICE BoxWalk begin_walk(READS(WorldBox) box, uint slots, uint levels, READS(BoxNode) tree) {
    BoxWalk walk;
    for (int k = 0; k < 3; ++k) {
        walk.box[k] = rounded_down(box->low[k]);
        walk.box[3 + k] = rounded_up(box->high[k]);
    }
    walk.trail = 0u;
    walk.level = levels - 1u;
    walk.first = nodes_below(slots, levels - 1u);
    walk.at = 0u;
    walk.children = lanes_in(walk.box, tree[walk.first].bounds);
    walk.tests = 1u;
    return walk;
}

// The place in the order of the next body whose box is near; NONE after the last.
DEVICE uint next_near(BoxWalk* walk, uint slots, uint levels, READS(BoxNode) tree) {
    for (;;) {
        if (walk->children != 0u) {
            const uint child = NODE_LANES * walk->at + lowest_bit(walk->children);
            walk->children &= walk->children - 1u;
            if (walk->level == 0u) return child;
            walk->trail = walk->trail << NODE_LANES | (ulong)walk->children;
            walk->level -= 1u;
            walk->first -= nodes_of(slots, walk->level);
            walk->at = child;
        } else if (walk->level + 1u < levels) {
            walk->first += nodes_of(slots, walk->level);
            walk->level += 1u;
            walk->at /= NODE_LANES;
            walk->children = (uint)(walk->trail & 0xffffu);
            walk->trail >>= NODE_LANES;
            continue;
        } else {
            walk->at += 1u;
            if (walk->at == nodes_of(slots, walk->level)) return NONE;
        }
        walk->children = lanes_in(walk->box, tree[walk->first + walk->at].bounds);
        walk->tests += 1u;
    }
}

// The bodies of a block that a wide body is tested against: those with a greater slot.
DEVICE uint first_of_block(uint block, uint slot) {
    return slot + 1u > BLOCK_BODIES * block ? slot + 1u : BLOCK_BODIES * block;
}
DEVICE uint end_of_block(uint block, uint slots) {
    return slots - BLOCK_BODIES * block < BLOCK_BODIES ? slots : BLOCK_BODIES * (block + 1u);
}

DEVICE uint blocks_of(uint slots) {
    return (slots - 1u) / BLOCK_BODIES + 1u;
}

// A list of pairs has a row for each slot and, behind that of a wide body, one for each of its blocks: so the rows are
// in the order of the pairs.
DEVICE uint row_of(uint slot, uint slots, uint wides, READS(uint) wide) {
    uint below = 0u, end = wides;
    while (below < end) {
        const uint middle = below + (end - below) / 2u;
        if (wide[middle] < slot)
            below = middle + 1u;
        else
            end = middle;
    }
    return slot + below * blocks_of(slots);
}

// How many pairs each body has with one of a greater slot. Item i < slots walks with the i-th box of the order, which
// near ones share memory with. A body near more than `few`, as a floor is, would keep one item busy for long: it is
// marked as wide, and the host lists it. The items from `slots` on test a block of bodies against each wide one, in the
// order of slots. counts: by row, columns of pairs, newly wide bodies, tests of nodes.
KERNEL void count_partners(COUNT(count), uint slots, uint levels, uint few, READS(BoxNode) tree, READS(SortKey) order,
                           READS(WorldBox) boxes, uint wides, READS(uint) wide, WRITES(uint) is_wide,
                           WRITES(uint) counts) {
    FOR_EACH(i, count) {
        uint pairs = 0u, near = 0u, tests = 0u, row;
        if (i < slots) {
            const uint slot = order[i].slot;
            row = row_of(slot, slots, wides, wide);
            if (is_wide[slot] == 0u && boxes[slot].low[0] <= boxes[slot].high[0]) {
                BoxWalk walk = begin_walk(boxes + slot, slots, levels, tree);
                for (uint at = 0u; near <= few && (at = next_near(&walk, slots, levels, tree)) != NONE; ++near) {
                    const uint other = order[at].slot;
                    if (other > slot) pairs += are_pair(boxes + slot, boxes + other);
                }
                tests = walk.tests;
                if (near > few) {
                    is_wide[slot] = 1u;
                    pairs = 0u;
                }
            }
        } else {
            const uint block = (i - slots) % blocks_of(slots), slot = wide[(i - slots) / blocks_of(slots)];
            row = row_of(slot, slots, wides, wide) + 1u + block;
            for (uint other = first_of_block(block, slot); other < end_of_block(block, slots); ++other)
                pairs += are_pair(boxes + slot, boxes + other);
        }
        counts[row] = pairs;
        counts[(ulong)ALL(count) + row] = near > few ? 1u : 0u;
        counts[2u * (ulong)ALL(count) + row] = tests;
    }
}

// By the second body, after Shell (1959): for a few it is an insertion sort.
DEVICE void sort_partners(WRITES(PairBodies) pairs, uint count) {
    uint gap = 1u;
    while (gap < count / 3u) gap = 3u * gap + 1u;
    for (; gap > 0u; gap /= 3u)
        for (uint i = gap; i < count; ++i) {
            const uint own = pairs[i].second;
            uint k = i;
            for (; k >= gap && pairs[k - gap].second > own; k -= gap) pairs[k].second = pairs[k - gap].second;
            pairs[k].second = own;
        }
}

// The pairs in the order of their bodies.
KERNEL void write_partners(COUNT(count), uint slots, uint levels, READS(BoxNode) tree, READS(SortKey) order,
                           READS(WorldBox) boxes, uint wides, READS(uint) wide, READS(uint) counts, READS(uint) firsts,
                           WRITES(PairBodies) pairs) {
    FOR_EACH(i, count) {
        if (i < slots) {
            const uint slot = order[i].slot, row = row_of(slot, slots, wides, wide), found = counts[row];
            if (found == 0u) continue;
            WRITES(PairBodies) own = pairs + firsts[row];
            BoxWalk walk = begin_walk(boxes + slot, slots, levels, tree);
            for (uint k = 0u; k < found;) {
                const uint other = order[next_near(&walk, slots, levels, tree)].slot;
                if (other <= slot || are_pair(boxes + slot, boxes + other) == 0u) continue;
                own[k].first = slot;
                own[k].second = other;
                ++k;
            }
            sort_partners(own, found);
        } else {
            const uint block = (i - slots) % blocks_of(slots), slot = wide[(i - slots) / blocks_of(slots)];
            uint at = firsts[row_of(slot, slots, wides, wide) + 1u + block];
            for (uint other = first_of_block(block, slot); other < end_of_block(block, slots); ++other) {
                if (are_pair(boxes + slot, boxes + other) == 0u) continue;
                pairs[at].first = slot;
                pairs[at].second = other;
                ++at;
            }
        }
    }
}

// A row of a list and the same one of the last list, side by side: where each is, and ends.
STRUCT(TwoRows) {
    uint at, end;
    uint last, last_end;
};

DEVICE TwoRows two_rows(uint row, READS(uint) counts, READS(uint) firsts, READS(uint) last_counts,
                        READS(uint) last_firsts) {
    TwoRows rows;
    rows.at = firsts[row];
    rows.end = firsts[row] + counts[row];
    rows.last = last_firsts[row];
    rows.last_end = last_firsts[row] + last_counts[row];
    return rows;
}

// The next pair that is in one of them alone. 0: none is left.
DEVICE uint next_difference(TwoRows* rows, READS(PairBodies) pairs, READS(PairBodies) last, PairDifference* found) {
    while (rows->at < rows->end || rows->last < rows->last_end) {
        const uint own = rows->at < rows->end ? pairs[rows->at].second : NONE;
        const uint other = rows->last < rows->last_end ? last[rows->last].second : NONE;
        if (own < other) {
            found->first = pairs[rows->at].first;
            found->second = own;
        } else if (other < own) {
            found->first = last[rows->last].first;
            found->second = other;
        }
        found->opened = own < other ? 1u : 0u;
        rows->at += own <= other ? 1u : 0u;
        rows->last += other <= own ? 1u : 0u;
        if (own != other) return 1u;
    }
    return 0u;
}

// How many pairs of each row opened or closed since the last list, which has the same rows. totals: of the list, which
// is not written where it had no room.
KERNEL void count_changed_pairs(COUNT(count), READS(Totals) totals, uint room, READS(uint) counts, READS(uint) firsts,
                                READS(PairBodies) pairs, READS(uint) last_counts, READS(uint) last_firsts,
                                READS(PairBodies) last, WRITES(uint) changes) {
    FOR_EACH(i, count) {
        uint found = 0u;
        if (totals->sums[0] <= room) {
            TwoRows rows = two_rows(i, counts, firsts, last_counts, last_firsts);
            PairDifference one;
            while (next_difference(&rows, pairs, last, &one) != 0u) ++found;
        }
        changes[i] = found;
    }
}

KERNEL void write_changed_pairs(COUNT(count), READS(uint) counts, READS(uint) firsts, READS(PairBodies) pairs,
                                READS(uint) last_counts, READS(uint) last_firsts, READS(PairBodies) last,
                                READS(uint) changes, READS(uint) change_firsts, WRITES(PairDifference) changed) {
    FOR_EACH(i, count) {
        if (changes[i] == 0u) continue;
        TwoRows rows = two_rows(i, counts, firsts, last_counts, last_firsts);
        PairDifference one;
        for (uint at = change_firsts[i]; next_difference(&rows, pairs, last, &one) != 0u; ++at) changed[at] = one;
    }
}
