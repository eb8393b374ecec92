// SPDX-License-Identifier: Apache-2.0
#include "device/cpu/kernel_table.h"
#include "shape/tree_walks.h"

#include <vector>

namespace raycontact::trees {

extern const Walks baseline;
#ifdef RAYCONTACT_X86
extern const Walks avx2, avx512;
#endif

std::span<const Walks* const> usable_walks() {
    static const std::vector<const Walks*> usable = [] {
        std::vector<const Walks*> found;
        for (const cpu::KernelTable* table : cpu::usable_tables())
            for (const Walks* walks : {
#ifdef RAYCONTACT_X86
                     &avx512, &avx2,
#endif
                     &baseline})
                if (table->instruction_set == walks->instruction_set) found.push_back(walks);
        return found;
    }();
    return usable;
}

} // namespace raycontact::trees
