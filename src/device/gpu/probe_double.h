// SPDX-License-Identifier: Apache-2.0
// As probe.h, for the operations that place pairs.

KERNEL void probe_double(COUNT(count), GLOBAL const double* RESTRICT operands, GLOBAL float* RESTRICT rounded,
                         GLOBAL double* RESTRICT results) {
    FOR_EACH(i, count) {
        const uint n = ALL(count);
        const double a = operands[3u * i], b = operands[3u * i + 1u], c = operands[3u * i + 2u];
        rounded[i] = (float)a;
        results[i] = a * b;
        results[n + i] = a - c;
        results[2u * n + i] = a * b + c;
    }
}
