// SPDX-License-Identifier: Apache-2.0
#pragma once

// The kernels' types and prototypes as the host sees them. A launch is typed by these prototypes on every device.
#include "device/cpu/dialect.h"

namespace raycontact::kernels {
#include "kernels/types.h"
namespace prototype {
#include "device/cpu/instruction_set.h"

#include "kernels/kernels.h"

#include "kernels/certified.h"
} // namespace prototype
} // namespace raycontact::kernels

namespace raycontact {

enum class KernelId : unsigned {
#define RAYCONTACT_KERNEL(name) name,
#define RAYCONTACT_CPU_KERNEL(name) name,
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL
    count
};

template <KernelId id>
struct Prototype;
#define RAYCONTACT_KERNEL(name)                                                                                        \
    template <>                                                                                                        \
    struct Prototype<KernelId::name> {                                                                                 \
        using type = decltype(&kernels::prototype::name);                                                              \
    };
#define RAYCONTACT_CPU_KERNEL(name) RAYCONTACT_KERNEL(name)
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL

/// Whether the kernel's items are blocks of vertices (FOR_EACH_VERTICES), which a GPU takes apart.
constexpr bool is_over_vertices(KernelId kernel) {
    return kernel == KernelId::count_rays || kernel == KernelId::write_rays || kernel == KernelId::count_edges
           || kernel == KernelId::count_near_rays || kernel == KernelId::write_near_rays;
}

} // namespace raycontact
