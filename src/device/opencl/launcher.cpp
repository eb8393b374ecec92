// SPDX-License-Identifier: Apache-2.0
#include "device/opencl/launcher.h"

#include <algorithm>

namespace raycontact::opencl {

namespace {

// One group size for all: some drivers compile a kernel again for each size (PoCL: 83 ms).
constexpr std::size_t items_in_group = 64;

// Enough to keep every unit busy to the end; more only cost time where there are few items.
std::size_t groups_for(cl_device_id device) {
    const std::size_t units = std::max<cl_uint>(value_of<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS), 1);
    return units * (is_cpu(device) ? 16 : 64);
}

cl_ulong time_of(cl_event event, cl_profiling_info what) {
    cl_ulong time = 0;
    check(clGetEventProfilingInfo(event, what, sizeof time, &time, nullptr), "clGetEventProfilingInfo");
    return time;
}

void set_argument(cl_kernel kernel, cl_uint at, cl_mem memory) {
    check(clSetKernelArg(kernel, at, sizeof(cl_mem), &memory), "clSetKernelArg");
}
void set_argument(cl_kernel kernel, cl_uint at, kernels::uint number) {
    check(clSetKernelArg(kernel, at, sizeof number, &number), "clSetKernelArg");
}
// The first two are the buffer of the count and its place there, or null and the count.
void set_arguments(cl_kernel kernel, const Count& count, std::span<const Argument> arguments) {
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

} // namespace

Launcher::Launcher(cl_context context, cl_device_id device) : most_groups_(groups_for(device)) {
    cl_int status = CL_SUCCESS;
    queue_.reset(clCreateCommandQueue(context, device, CL_QUEUE_PROFILING_ENABLE, &status));
    check(status, "clCreateCommandQueue");
}

void Launcher::over_items(cl_kernel kernel, const char* name, std::size_t most, const Count& count,
                          std::span<const Argument> arguments) {
    in_groups(kernel, name, items_in_group,
              std::clamp<std::size_t>((most + items_in_group - 1) / items_in_group, 1, most_groups_), count, arguments);
}

void Launcher::in_groups(cl_kernel kernel, const char* name, std::size_t group_size, std::size_t groups,
                         const Count& count, std::span<const Argument> arguments) {
    set_arguments(kernel, count, arguments);
    const std::size_t all = group_size * groups;
    cl_event event = nullptr;
    check(clEnqueueNDRangeKernel(queue_.get(), kernel, 1, nullptr, &all, &group_size, 0, nullptr, &event), name);
    started_.emplace_back(event);
}

void Launcher::add_up() {
    for (const Event& event : started_)
        busy_ns_ += time_of(event.get(), CL_PROFILING_COMMAND_END) - time_of(event.get(), CL_PROFILING_COMMAND_START);
    started_.clear();
}

} // namespace raycontact::opencl
