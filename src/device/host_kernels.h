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

/// How many items a GPU makes of one of the host's: these kernels' are blocks of vertices.
constexpr kernels::uint vertices_each(KernelId kernel) {
    switch (kernel) {
    case KernelId::count_rays:
    case KernelId::write_rays:
    case KernelId::count_near_rays:
    case KernelId::write_near_rays:
        return VERTEX_LANES;
    default:
        return 1;
    }
}

} // namespace raycontact
