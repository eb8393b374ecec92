// SPDX-License-Identifier: Apache-2.0
// Exclusive prefix sum in three passes without barriers: sums of blocks, offsets of blocks, offsets of elements.
#define SCAN_BLOCK 1024

KERNEL void scan_sums(RANGE uint blocks, uint count, GLOBAL const uint* RESTRICT values, GLOBAL uint* RESTRICT sums) {
    FOR_EACH(b, blocks) {
        const uint end = count - b * SCAN_BLOCK < SCAN_BLOCK ? count : (b + 1u) * SCAN_BLOCK;
        uint sum = 0u;
        for (uint i = b * SCAN_BLOCK; i < end; ++i) sum += values[i];
        sums[b] = sum;
    }
}

// One work item; sums[blocks] becomes the total, NONE where 32 bits cannot hold it.
KERNEL void scan_offsets(RANGE uint one, uint blocks, GLOBAL uint* RESTRICT sums) {
    FOR_EACH(only, one) {
        ulong sum = only;
        for (uint b = 0u; b < blocks; ++b) {
            const uint own = sums[b];
            sums[b] = (uint)sum;
            sum += own;
        }
        sums[blocks] = sum < (ulong)NONE ? (uint)sum : NONE;
    }
}

KERNEL void scan_write(RANGE uint blocks, uint count, GLOBAL const uint* RESTRICT values,
                       GLOBAL const uint* RESTRICT sums, GLOBAL uint* RESTRICT firsts) {
    FOR_EACH(b, blocks) {
        const uint end = count - b * SCAN_BLOCK < SCAN_BLOCK ? count : (b + 1u) * SCAN_BLOCK;
        uint sum = sums[b];
        for (uint i = b * SCAN_BLOCK; i < end; ++i) {
            firsts[i] = sum;
            sum += values[i];
        }
    }
}
