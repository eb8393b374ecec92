// SPDX-License-Identifier: Apache-2.0
// What rounding took from p = fl(a * b), exactly; by one fused multiply-add, or by splitting (Dekker 1971): the same
// bits either way. Included once per instruction set, inside its namespace.
#ifdef __FMA__
DEVICE float product_error(float a, float b, float p) {
    return __builtin_fmaf(a, b, -p);
}
#else
DEVICE float product_error(float a, float b, float p) {
    const float wide_a = 4097.0f * a, wide_b = 4097.0f * b;
    const float high_a = wide_a - (wide_a - a), high_b = wide_b - (wide_b - b);
    const float low_a = a - high_a, low_b = b - high_b;
    return low_a * low_b - (((p - high_a * high_b) - low_a * high_b) - high_a * low_b);
}
#endif
