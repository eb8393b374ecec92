// SPDX-License-Identifier: Apache-2.0
// The part of the dialect that depends on the instruction set; included once for each, inside its namespace. All give
// the same bits.

// The rounding error of p = fl(a * b): by one fused multiply-add, or in double, which can represent every product of
// two floats and its difference from p. Either rounds once, so the bits are the same for every a and b.
#ifdef __FMA__
DEVICE float product_error(float a, float b, float p) {
    return __builtin_fmaf(a, b, -p);
}
#else
DEVICE float product_error(float a, float b, float p) {
    return (float)((double)a * (double)b - (double)p);
}
#endif

// A bit for each lane that is -1; the others are 0. Compilers reduce sixteen lanes in eight instructions; one or two
// do.
DEVICE uint pack_sixteen(const int* lanes) {
#if defined(__AVX512DQ__)
    return _mm512_movepi32_mask(_mm512_loadu_si512(lanes));
#elif defined(__AVX2__)
    const auto eight = [](const int* from) {
        return static_cast<uint>(_mm256_movemask_ps(_mm256_loadu_ps(reinterpret_cast<const float*>(from))));
    };
    return eight(lanes) | eight(lanes + 8) << 8;
#elif defined(__SSE2__) || defined(_M_X64)
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
DEVICE uint pack_vertices(const int* lanes) {
    return pack_sixteen(lanes);
}
