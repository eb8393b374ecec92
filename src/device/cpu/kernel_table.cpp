// SPDX-License-Identifier: Apache-2.0
#include "device/cpu/kernel_table.h"

#include <vector>

namespace raycontact::cpu {

extern const KernelTable baseline;
#ifdef RAYCONTACT_X86
extern const KernelTable avx2, avx512;
#endif

std::span<const KernelTable* const> usable_tables() {
    static const std::vector<const KernelTable*> tables = [] {
        std::vector<const KernelTable*> found;
#ifdef RAYCONTACT_X86
        __builtin_cpu_init();
        const bool has_avx2 =
            __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi");
        if (has_avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl")
            && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq"))
            found.push_back(&avx512);
        if (has_avx2) found.push_back(&avx2);
#endif
        found.push_back(&baseline);
        return found;
    }();
    return tables;
}

} // namespace raycontact::cpu
