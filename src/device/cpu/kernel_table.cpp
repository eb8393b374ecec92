// SPDX-License-Identifier: Apache-2.0
#include "device/cpu/kernel_table.h"

#include <algorithm>
#include <initializer_list>
#include <vector>
#if defined(RAYCONTACT_X86) && defined(_MSC_VER)
#include <immintrin.h>
#include <intrin.h>
#endif

namespace raycontact::cpu {

extern const KernelTable baseline;
#ifdef RAYCONTACT_X86
extern const KernelTable avx2, avx512;
#endif

#ifdef RAYCONTACT_X86
namespace {

struct Features {
    bool avx2, avx512;
};

#ifdef _MSC_VER
Features features() {
    int highest[4], basic[4], more[4];
    __cpuid(highest, 0);
    if (highest[0] < 7) return {};
    __cpuid(basic, 1);
    __cpuidex(more, 7, 0);
    const auto has = [](int word, std::initializer_list<int> bits) {
        return std::ranges::all_of(bits, [word](int bit) { return (word >> bit & 1) != 0; });
    };
    if (!has(basic[2], {12, 27, 28})) return {}; // fma, osxsave, avx
    // What the system saves when it switches threads: 0x6 the registers of AVX, 0xe0 those of AVX-512.
    const unsigned long long saved = _xgetbv(0);
    const bool avx2 = (saved & 0x6) == 0x6 && has(more[1], {3, 5});                  // bmi, avx2
    return {avx2, avx2 && (saved & 0xe0) == 0xe0 && has(more[1], {16, 17, 30, 31})}; // avx512f, dq, bw, vl
}
#else
Features features() {
    __builtin_cpu_init();
    const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi");
    return {avx2, avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl")
                      && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq")};
}
#endif

} // namespace
#endif

std::span<const KernelTable* const> usable_tables() {
    static const std::vector<const KernelTable*> tables = [] {
        std::vector<const KernelTable*> found;
#ifdef RAYCONTACT_X86
        const Features has = features();
        if (has.avx512) found.push_back(&avx512);
        if (has.avx2) found.push_back(&avx2);
#endif
        found.push_back(&baseline);
        return found;
    }();
    return tables;
}

} // namespace raycontact::cpu
