// SPDX-License-Identifier: Apache-2.0
// The dialect's words that depend on the instruction set; included once for each, inside its namespace. The same bits
// from all of them.

// What rounding took from p = fl(a * b), exactly: by one fused multiply-add, or by splitting (Dekker 1971).
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

// A bit for each lane that is not 0: compilers reduce sixteen lanes in eight instructions where one or two do.
#if defined(__AVX512DQ__) && defined(__AVX512VL__)
DEVICE uint pack_sixteen(const int* lanes) {
    return _mm512_movepi32_mask(_mm512_loadu_si512(lanes));
}
DEVICE uint pack_eight(const int* lanes) {
    return _mm256_movepi32_mask(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(lanes)));
}
#elif defined(__AVX2__)
DEVICE uint pack_eight(const int* lanes) {
    return static_cast<uint>(_mm256_movemask_ps(_mm256_loadu_ps(reinterpret_cast<const float*>(lanes))));
}
DEVICE uint pack_sixteen(const int* lanes) {
    return pack_eight(lanes) | pack_eight(lanes + 8) << 8;
}
#elif defined(__SSE2__)
DEVICE uint pack_eight(const int* lanes) {
    const float* bits = reinterpret_cast<const float*>(lanes);
    return static_cast<uint>(_mm_movemask_ps(_mm_loadu_ps(bits)) | _mm_movemask_ps(_mm_loadu_ps(bits + 4)) << 4);
}
DEVICE uint pack_sixteen(const int* lanes) {
    return pack_eight(lanes) | pack_eight(lanes + 8) << 8;
}
#else
DEVICE uint pack_eight(const int* lanes) {
    uint bits = 0;
    for (int k = 0; k < 8; ++k) bits |= lane_bit(k) & static_cast<uint>(lanes[k]);
    return bits;
}
DEVICE uint pack_sixteen(const int* lanes) {
    return pack_eight(lanes) | pack_eight(lanes + 8) << 8;
}
#endif
