// SPDX-License-Identifier: Apache-2.0
// Every operation that decides a contact: a device is exact if it computes them all as the host does. Result k of item
// i lies at k * count + i.

KERNEL void probe_float(COUNT(count), GLOBAL const float* RESTRICT operands, GLOBAL float* RESTRICT results) {
    FOR_EACH(i, count) {
        const uint n = ALL(count);
        const float a = operands[4u * i], b = operands[4u * i + 1u], c = operands[4u * i + 2u];
        const float denormal = operands[4u * i + 3u];
        const float product = a * b;
        results[i] = product;
        results[n + i] = a + b;
        results[2u * n + i] = a * b + c; // rounded twice, unless contracted
        results[3u * n + i] = a / b;
        results[4u * n + i] = root_of(magnitude_of(a));
        results[5u * n + i] = 0.75f * denormal;
        results[6u * n + i] = product_error(a, b, product);
        results[7u * n + i] = (float)(i * 2654435761u);
    }
}
