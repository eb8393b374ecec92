// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/cuda/arguments.h"

#include <vector>

namespace raycontact::cuda {

/// Starts kernels in order, and adds up how long they ran. The context is current in every call.
class Launcher {
public:
    Launcher(std::shared_ptr<const Context> context, std::uint32_t multiprocessors);

    /// Starts as many threads as the device can use, and no more than there may be items.
    void over_items(FunctionHandle kernel, const char* name, std::size_t most, Arguments& arguments);
    void in_groups(FunctionHandle kernel, const char* name, std::size_t group_size, std::size_t groups,
                   Arguments& arguments);

    /// Waits for everything that was started.
    void finish();
    double busy_ms() const { return busy_ms_; }

private:
    struct Timed {
        Event begin, end;
    };

    std::shared_ptr<const Context> context_;
    std::size_t most_groups_;
    std::vector<Timed> timed_; ///< kept from step to step
    std::size_t started_ = 0;  ///< of timed_
    double busy_ms_ = 0;
};

} // namespace raycontact::cuda
