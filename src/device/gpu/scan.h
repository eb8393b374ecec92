// SPDX-License-Identifier: Apache-2.0
// The sums of a table (ScanOf, device.h) for devices whose threads work in groups: one kernel for few items, three for
// more. Integers, so that no order changes a bit. Only this file uses the dialects' macros for groups.
// NOLINTBEGIN(modernize-use-using): this text is C as well

// Part `part` of `parts` of n items.
typedef struct {
    ulong begin, end;
} Slice;

DEVICE Slice slice_of(ulong begin, ulong end, uint part, uint parts) {
    const ulong size = (end - begin + parts - 1u) / parts;
    Slice slice;
    slice.begin = begin + part * size < end ? begin + part * size : end;
    slice.end = end - slice.begin < size ? end : slice.begin + size;
    return slice;
}

DEVICE ulong sum_of(GLOBAL const uint* RESTRICT values, const Slice slice) {
    ulong sum = 0u;
    for (ulong i = slice.begin; i < slice.end; ++i) sum += values[i];
    return sum;
}

// Beyond 2^32 the firsts are wrong, but then there is no room either.
DEVICE void write_firsts(GLOBAL const uint* RESTRICT values, const Slice slice, ulong before,
                         GLOBAL uint* RESTRICT firsts) {
    uint at = (uint)before;
    for (ulong i = slice.begin; i < slice.end; ++i) {
        firsts[i] = at;
        at += values[i];
    }
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

DEVICE uint saturated(ulong sum) {
    return sum < NONE ? (uint)sum : NONE;
}

DEVICE void set_totals(GLOBAL Totals* RESTRICT totals, uint column, ulong sum, uint count, uint room) {
    if (column == 0u) {
        totals->items = sum > 0u && sum <= room ? count : 0u;
        totals->results = sum <= room ? (uint)sum : 0u;
        for (uint c = 1u; c < MOST_COLUMNS; ++c) totals->sums[c] = 0u;
    }
    totals->sums[column] = saturated(sum);
}

// One group, for up to SCAN_AT_ONCE items.
GROUP_KERNEL void scan_at_once(COUNT(count), uint columns, uint stride, GLOBAL const uint* RESTRICT values,
                               GLOBAL uint* RESTRICT firsts, GLOBAL Totals* RESTRICT totals, uint at, uint room) {
    SHARED(ulong, shared, SCAN_GROUP);
    const uint n = ALL(count);
    const Slice slice = slice_of(0u, n, THREAD, SCAN_GROUP);
    for (uint c = 0u; c < columns; ++c) {
        ulong total;
        const ulong before = sum_before(sum_of(values + (ulong)c * stride, slice), shared, &total);
        if (c == 0u) write_firsts(values, slice, before, firsts);
        if (THREAD == 0u) set_totals(totals + at, c, total, n, room);
    }
}

// SCAN_GROUP groups, a block of items each. sums[c * SCAN_GROUP + b]: of block b.
GROUP_KERNEL void scan_blocks(COUNT(count), uint columns, uint stride, GLOBAL const uint* RESTRICT values,
                              GLOBAL ulong* RESTRICT sums) {
    SHARED(ulong, shared, SCAN_GROUP);
    const Slice block = slice_of(0u, ALL(count), GROUP, SCAN_GROUP);
    const Slice slice = slice_of(block.begin, block.end, THREAD, SCAN_GROUP);
    for (uint c = 0u; c < columns; ++c) {
        ulong total;
        sum_before(sum_of(values + (ulong)c * stride, slice), shared, &total);
        if (THREAD == 0u) sums[c * SCAN_GROUP + GROUP] = total;
    }
}

// One group, a thread a block: the sum of each block in column 0 becomes the sum of the blocks before it.
GROUP_KERNEL void scan_sums(COUNT(count), uint columns, GLOBAL ulong* RESTRICT sums, GLOBAL Totals* RESTRICT totals,
                            uint at, uint room) {
    SHARED(ulong, shared, SCAN_GROUP);
    for (uint c = 0u; c < columns; ++c) {
        ulong total;
        const ulong before = sum_before(sums[c * SCAN_GROUP + THREAD], shared, &total);
        if (c == 0u) sums[THREAD] = before;
        if (THREAD == 0u) set_totals(totals + at, c, total, ALL(count), room);
    }
}

GROUP_KERNEL void scan_firsts(COUNT(count), GLOBAL const uint* RESTRICT values, GLOBAL const ulong* RESTRICT sums,
                              GLOBAL uint* RESTRICT firsts) {
    SHARED(ulong, shared, SCAN_GROUP);
    const Slice block = slice_of(0u, ALL(count), GROUP, SCAN_GROUP);
    const Slice slice = slice_of(block.begin, block.end, THREAD, SCAN_GROUP);
    ulong total;
    const ulong before = sum_before(sum_of(values, slice), shared, &total);
    write_firsts(values, slice, sums[GROUP] + before, firsts);
}
// NOLINTEND(modernize-use-using)
