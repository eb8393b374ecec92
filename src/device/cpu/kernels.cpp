// SPDX-License-Identifier: Apache-2.0
// The kernels for one instruction set; CMake compiles this file once for each, with its flags.
#include "device/cpu/kernel_table.h"

namespace raycontact::kernels::RAYCONTACT_ISA {
#include "device/cpu/instruction_set.h"

#include "kernels/kernels.h"

#include "kernels/certified.h"
} // namespace raycontact::kernels::RAYCONTACT_ISA

#define RAYCONTACT_STRING_(x) #x
#define RAYCONTACT_STRING(x) RAYCONTACT_STRING_(x)

namespace raycontact::cpu {

extern const KernelTable RAYCONTACT_ISA;
const KernelTable RAYCONTACT_ISA = {RAYCONTACT_STRING(RAYCONTACT_ISA),
                                    {
#define RAYCONTACT_KERNEL(name) &Unpacked<&kernels::RAYCONTACT_ISA::name>::run,
#define RAYCONTACT_CPU_KERNEL(name) RAYCONTACT_KERNEL(name)
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL
                                    }};

} // namespace raycontact::cpu
