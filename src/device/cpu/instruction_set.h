// SPDX-License-Identifier: Apache-2.0
// The dialect's words that depend on the instruction set; included once for each, inside its namespace. The same bits
// from all of them.

// What rounding took from p = fl(a * b), exactly: by one fused multiply-add, or by splitting (Dekker 1971), which alone
// would leave some zeros negative.
#ifdef __FMA__
DEVICE float product_error(float a, float b, float p) {
    return __builtin_fmaf(a, b, -p);
}
#else
DEVICE float product_error(float a, float b, float p) {
    const float wide_a = 4097.0f * a, wide_b = 4097.0f * b;
    const float high_a = wide_a - (wide_a - a), high_b = wide_b - (wide_b - b);
    const float low_a = a - high_a, low_b = b - high_b;
    return low_a * low_b - (((p - high_a * high_b) - low_a * high_b) - high_a * low_b) + 0.0f;
}
#endif

// A bit for each lane that is -1, the others being 0: compilers reduce sixteen lanes in eight instructions where one or
// two do.
DEVICE uint pack_sixteen(const int* lanes) {
#if defined(__AVX512DQ__)
    return _mm512_movepi32_mask(_mm512_loadu_si512(lanes));
#elif defined(__AVX2__)
    const auto eight = [](const int* from) {
        return static_cast<uint>(_mm256_movemask_ps(_mm256_loadu_ps(reinterpret_cast<const float*>(from))));
    };
    return eight(lanes) | eight(lanes + 8) << 8;
#elif defined(__SSE2__)
    const auto four = [](const int* from) {
        return static_cast<uint>(_mm_movemask_ps(_mm_loadu_ps(reinterpret_cast<const float*>(from))));
    };
    return four(lanes) | four(lanes + 4) << 4 | four(lanes + 8) << 8 | four(lanes + 12) << 12;
#else
    uint bits = 0;
    for (int k = 0; k < 16; ++k) bits |= static_cast<uint>(lanes[k]) & (1u << k);
    return bits;
#endif
}
