// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/opencl/buffer.h"

namespace raycontact::opencl {

inline void set_argument(cl_kernel kernel, cl_uint at, cl_mem memory) {
    check(clSetKernelArg(kernel, at, sizeof(cl_mem), &memory), "clSetKernelArg");
}
inline void set_argument(cl_kernel kernel, cl_uint at, kernels::uint number) {
    check(clSetKernelArg(kernel, at, sizeof number, &number), "clSetKernelArg");
}
/// The first two are the buffer of the count and its place there, or null and the count.
inline void set_arguments(cl_kernel kernel, const Count& count, std::span<const Argument> arguments) {
    set_argument(kernel, 0, memory_of(count.buffer));
    set_argument(kernel, 1, count.value);
    cl_uint at = 2;
    for (const Argument& argument : arguments) {
        if (argument.is_scalar)
            set_argument(kernel, at++, argument.scalar);
        else
            set_argument(kernel, at++, memory_of(argument.buffer));
    }
}

} // namespace raycontact::opencl
