// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/opencl/handle.h"

#include <vector>

namespace raycontact::opencl {

/// Starts kernels in order, and adds up how long they ran.
class Launcher {
public:
    Launcher(cl_context context, cl_device_id device);

    cl_command_queue queue() const { return queue_.get(); }
    /// Starts as many threads as the device can use, and no more than there may be items.
    void over_items(cl_kernel kernel, const char* name, std::size_t most, const Count& count,
                    std::span<const Argument> arguments);
    void in_groups(cl_kernel kernel, const char* name, std::size_t group_size, std::size_t groups, const Count& count,
                   std::span<const Argument> arguments);

    /// Call it once everything that was started has finished.
    void add_up();
    double busy_ms() const { return static_cast<double>(busy_ns_) * 1e-6; }

private:
    CommandQueue queue_;
    std::size_t most_groups_ = 1;
    std::vector<Event> started_;
    cl_ulong busy_ns_ = 0;
};

} // namespace raycontact::opencl
