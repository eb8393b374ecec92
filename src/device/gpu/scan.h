// SPDX-License-Identifier: Apache-2.0
// The sums of a table (ScanOf, device.h) for devices whose threads work in groups: one kernel for few items, three for
// more. Integers, so that no order changes a bit. Only this file uses the dialects' macros for groups.
// NOLINTBEGIN(modernize-use-using): this text is C as well

// Part `part` of `parts` of n items.
typedef struct {
    ulong begin, end;
} Slice;

DEVICE Slice slice_of(uint n, uint part, uint parts) {
    const ulong size = ((ulong)n + parts - 1u) / parts;
    Slice slice;
    slice.begin = part * size < n ? part * size : n;
    slice.end = n - slice.begin < size ? n : slice.begin + size;
    return slice;
}

// The sum over the threads before this one; total: over all threads. shared: one element for each thread.
DEVICE ulong sum_before(ulong own, LOCAL ulong* shared, ulong* total) {
    shared[THREAD] = own;
    BARRIER;
    for (uint step = 1u; step < SCAN_GROUP; step *= 2u) {
        const ulong other = THREAD >= step ? shared[THREAD - step] : 0u;
        BARRIER;
        shared[THREAD] += other;
        BARRIER;
    }
    const ulong before = shared[THREAD] - own;
    *total = shared[SCAN_GROUP - 1u];
    BARRIER;
    return before;
}

// The sum over a group's items. Neighbours read neighbours: a read of memory serves many threads.
DEVICE ulong sum_of(GLOBAL const uint* RESTRICT values, const Slice slice, LOCAL ulong* shared) {
    ulong own = 0u, total;
    for (ulong i = slice.begin + THREAD; i < slice.end; i += SCAN_GROUP) own += values[i];
    sum_before(own, shared, &total);
    return total;
}

// A thread's items lie in a row in shared memory; the gaps keep the threads of a warp in different banks.
#define SCAN_TILE (SCAN_GROUP * SCAN_ITEMS)
#define TILE_PLACE(k) ((k) + (k) / 32u)
#define TILE_PLACES (SCAN_TILE + SCAN_TILE / 32u)

// Writes the firsts of a group's items, tile by tile, of which `before` come before. Returns the sum over the items.
// Beyond 2^32 the firsts are wrong, but then there is no room either.
DEVICE ulong write_firsts(GLOBAL const uint* RESTRICT values, const Slice slice, ulong before, LOCAL ulong* shared,
                          LOCAL uint* tile, GLOBAL uint* RESTRICT firsts) {
    ulong sum = 0u;
    for (ulong begin = slice.begin; begin < slice.end; begin += SCAN_TILE) {
        const uint n = slice.end - begin < SCAN_TILE ? (uint)(slice.end - begin) : SCAN_TILE;
        for (uint k = THREAD; k < n; k += SCAN_GROUP) tile[TILE_PLACE(k)] = values[begin + k];
        BARRIER;
        const uint first = THREAD * SCAN_ITEMS, last = first + SCAN_ITEMS < n ? first + SCAN_ITEMS : n;
        ulong own = 0u, total;
        for (uint k = first; k < last; ++k) own += tile[TILE_PLACE(k)];
        uint at = (uint)(before + sum + sum_before(own, shared, &total));
        for (uint k = first; k < last; ++k) {
            const uint value = tile[TILE_PLACE(k)];
            tile[TILE_PLACE(k)] = at;
            at += value;
        }
        BARRIER;
        for (uint k = THREAD; k < n; k += SCAN_GROUP) firsts[begin + k] = tile[TILE_PLACE(k)];
        BARRIER;
        sum += total;
    }
    return sum;
}

DEVICE uint saturated(ulong sum) {
    return sum < NONE ? (uint)sum : NONE;
}

DEVICE void set_totals(GLOBAL Totals* RESTRICT totals, uint column, ulong sum, uint count, uint room, uint before) {
    if (column == 0u) {
        const ulong results = before + sum;
        totals->items = sum > 0u && results <= room ? count : 0u;
        totals->results = results <= room ? (uint)results : 0u;
        for (uint c = 1u; c < MOST_COLUMNS; ++c) totals->sums[c] = 0u;
    }
    totals->sums[column] = saturated(sum);
}

// One group, for up to SCAN_AT_ONCE items.
GROUP_KERNEL void scan_at_once(COUNT(count), uint columns, uint stride, GLOBAL const uint* RESTRICT values,
                               GLOBAL uint* RESTRICT firsts, GLOBAL Totals* RESTRICT totals, uint at, uint room,
                               uint before) {
    SHARED(ulong, shared, SCAN_GROUP);
    SHARED(uint, tile, TILE_PLACES);
    const uint n = ALL(count);
    const Slice all = slice_of(n, 0u, 1u);
    for (uint c = 0u; c < columns; ++c) {
        const ulong sum = c == 0u ? write_firsts(values, all, before, shared, tile, firsts)
                                  : sum_of(values + (ulong)c * stride, all, shared);
        if (THREAD == 0u) set_totals(totals + at, c, sum, n, room, before);
    }
}

// A block of items each group. sums[c * SCAN_GROUP + b]: of block b.
GROUP_KERNEL void scan_blocks(COUNT(count), uint columns, uint stride, GLOBAL const uint* RESTRICT values,
                              GLOBAL ulong* RESTRICT sums) {
    SHARED(ulong, shared, SCAN_GROUP);
    const Slice block = slice_of(ALL(count), GROUP, GROUPS);
    for (uint c = 0u; c < columns; ++c) {
        const ulong sum = sum_of(values + (ulong)c * stride, block, shared);
        if (THREAD == 0u) sums[c * SCAN_GROUP + GROUP] = sum;
    }
}

// One group, a thread a block: the sum of each block in column 0 becomes that of `before` and the blocks before it.
GROUP_KERNEL void scan_sums(COUNT(count), uint columns, uint blocks, GLOBAL ulong* RESTRICT sums,
                            GLOBAL Totals* RESTRICT totals, uint at, uint room, uint before) {
    SHARED(ulong, shared, SCAN_GROUP);
    for (uint c = 0u; c < columns; ++c) {
        ulong total;
        const ulong own = THREAD < blocks ? sums[c * SCAN_GROUP + THREAD] : 0u;
        const ulong sum = sum_before(own, shared, &total);
        if (c == 0u && THREAD < blocks) sums[THREAD] = before + sum;
        if (THREAD == 0u) set_totals(totals + at, c, total, ALL(count), room, before);
    }
}

GROUP_KERNEL void scan_firsts(COUNT(count), GLOBAL const uint* RESTRICT values, GLOBAL const ulong* RESTRICT sums,
                              GLOBAL uint* RESTRICT firsts) {
    SHARED(ulong, shared, SCAN_GROUP);
    SHARED(uint, tile, TILE_PLACES);
    write_firsts(values, slice_of(ALL(count), GROUP, GROUPS), sums[GROUP], shared, tile, firsts);
}
// NOLINTEND(modernize-use-using)
