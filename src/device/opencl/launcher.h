// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/opencl/handle.h"

#include <algorithm>
#include <vector>

namespace raycontact::opencl {

/// Starts kernels in order, and adds up how long they ran.
class Launcher {
public:
    Launcher(cl_context context, cl_device_id device) {
        // Enough to keep every unit busy to the end; more only cost time where there are few items.
        most_groups_ = std::max<cl_uint>(value_of<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS), 1)
                       * std::size_t{is_cpu(device) ? 16u : 64u};
        cl_int status = CL_SUCCESS;
        queue_.reset(clCreateCommandQueue(context, device, CL_QUEUE_PROFILING_ENABLE, &status));
        check(status, "clCreateCommandQueue");
    }

    cl_command_queue queue() const { return queue_.get(); }
    /// Starts as many threads as the device can use, and no more than there may be items.
    void over_items(cl_kernel kernel, const char* name, std::size_t most, const Count& count,
                    std::span<const Argument> arguments) {
        // One group size for all: some drivers compile a kernel again for each size (PoCL: 83 ms).
        constexpr std::size_t items_in_group = 64;
        in_groups(kernel, name, items_in_group,
                  std::clamp<std::size_t>((most + items_in_group - 1) / items_in_group, 1, most_groups_), count,
                  arguments);
    }
    void in_groups(cl_kernel kernel, const char* name, std::size_t group_size, std::size_t groups, const Count& count,
                   std::span<const Argument> arguments) {
        // The first two are the buffer of the count and its place there, or null and the count.
        cl_uint at = 0;
        set_argument(kernel, at++, memory_of(count.buffer));
        set_argument(kernel, at++, count.value);
        for (const Argument& argument : arguments)
            argument.is_scalar ? set_argument(kernel, at++, argument.scalar)
                               : set_argument(kernel, at++, memory_of(argument.buffer));
        const std::size_t all = group_size * groups;
        cl_event event = nullptr;
        check(clEnqueueNDRangeKernel(queue_.get(), kernel, 1, nullptr, &all, &group_size, 0, nullptr, &event), name);
        started_.emplace_back(event);
    }

    /// Call it once everything that was started has finished.
    void add_up() {
        for (const Event& event : started_)
            busy_ns_ += time_of(event, CL_PROFILING_COMMAND_END) - time_of(event, CL_PROFILING_COMMAND_START);
        started_.clear();
    }
    double busy_ms() const { return static_cast<double>(busy_ns_) * 1e-6; }

private:
    template <typename Value>
    static void set_argument(cl_kernel kernel, cl_uint at, Value value) {
        // NOLINTNEXTLINE(bugprone-sizeof-expression): of a buffer the argument is its handle
        check(clSetKernelArg(kernel, at, sizeof value, &value), "clSetKernelArg");
    }
    static cl_ulong time_of(const Event& event, cl_profiling_info what) {
        cl_ulong time = 0;
        check(clGetEventProfilingInfo(event.get(), what, sizeof time, &time, nullptr), "clGetEventProfilingInfo");
        return time;
    }

    CommandQueue queue_;
    std::size_t most_groups_ = 1;
    std::vector<Event> started_;
    cl_ulong busy_ns_ = 0;
};

} // namespace raycontact::opencl
