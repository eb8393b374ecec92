// SPDX-License-Identifier: Apache-2.0
#include "bench/micro/limits.h"

#include <immintrin.h>

namespace raycontact::bench {

namespace {

// Seven chains of each kind, all in registers, hide the latency of the units. Zero and one stay what they are; the
// empty asm keeps the compiler from noticing.
#define RAYCONTACT_SPEND(name, features, vector, add, multiply, one)                                                   \
    __attribute__((target(features))) std::uint64_t name(std::uint64_t rounds) {                                       \
        vector sum0{}, sum1{}, sum2{}, sum3{}, sum4{}, sum5{}, sum6{};                                                 \
        vector product0 = one(1), product1 = one(1), product2 = one(1), product3 = one(1), product4 = one(1),          \
               product5 = one(1), product6 = one(1);                                                                   \
        for (std::uint64_t i = 0; i < rounds; ++i) {                                                                   \
            asm volatile("" : "+v"(sum0), "+v"(sum1), "+v"(sum2), "+v"(sum3), "+v"(sum4), "+v"(sum5), "+v"(sum6));     \
            asm volatile(""                                                                                            \
                         : "+v"(product0), "+v"(product1), "+v"(product2), "+v"(product3), "+v"(product4),             \
                           "+v"(product5), "+v"(product6));                                                            \
            sum0 = add(sum0, sum0), product0 = multiply(product0, product0);                                           \
            sum1 = add(sum1, sum1), product1 = multiply(product1, product1);                                           \
            sum2 = add(sum2, sum2), product2 = multiply(product2, product2);                                           \
            sum3 = add(sum3, sum3), product3 = multiply(product3, product3);                                           \
            sum4 = add(sum4, sum4), product4 = multiply(product4, product4);                                           \
            sum5 = add(sum5, sum5), product5 = multiply(product5, product5);                                           \
            sum6 = add(sum6, sum6), product6 = multiply(product6, product6);                                           \
        }                                                                                                              \
        return rounds * 14 * sizeof(vector) / sizeof(float);                                                           \
    }

RAYCONTACT_SPEND(spend_sse2, "sse2", __m128, _mm_add_ps, _mm_mul_ps, _mm_set1_ps)
RAYCONTACT_SPEND(spend_avx2, "avx2", __m256, _mm256_add_ps, _mm256_mul_ps, _mm256_set1_ps)
RAYCONTACT_SPEND(spend_avx512, "avx512f", __m512, _mm512_add_ps, _mm512_mul_ps, _mm512_set1_ps)
#undef RAYCONTACT_SPEND

} // namespace

std::uint64_t spend_cycles(std::uint64_t rounds) {
    std::uint64_t x = 3;
    for (std::uint64_t i = 0; i < rounds; ++i)
        asm volatile("imul %0, %0\n\timul %0, %0\n\timul %0, %0\n\timul %0, %0\n\t"
                     "imul %0, %0\n\timul %0, %0\n\timul %0, %0\n\timul %0, %0\n\t"
                     "imul %0, %0\n\timul %0, %0\n\timul %0, %0\n\timul %0, %0\n\t"
                     "imul %0, %0\n\timul %0, %0\n\timul %0, %0\n\timul %0, %0"
                     : "+r"(x)
                     :
                     : "cc");
    return rounds * 16 * 3;
}

std::uint64_t spend_operations(std::string_view instruction_set, std::uint64_t rounds) {
    if (instruction_set == "avx512") return spend_avx512(rounds);
    if (instruction_set == "avx2") return spend_avx2(rounds);
    return spend_sse2(rounds);
}

} // namespace raycontact::bench
