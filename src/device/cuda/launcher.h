// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/cuda/handle.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace raycontact::cuda {

/// The parameters of a launch as the driver takes them: where each value lies.
class Arguments {
public:
    /// The first two are the buffer of the count and its place there, or null and the count.
    Arguments(const Count& count, std::span<const Argument> given) {
        if (given.size() + 2 > most) throw std::logic_error("more arguments than a kernel may have");
        add(address_of(count.buffer));
        add(count.value);
        for (const Argument& argument : given)
            argument.is_scalar ? add(argument.scalar) : add(address_of(argument.buffer));
    }
    Arguments(const Arguments&) = delete;
    Arguments& operator=(const Arguments&) = delete;

    void** places() { return places_.data(); }

private:
    static constexpr std::size_t most = 32;

    template <typename T>
    void add(T value) {
        std::memcpy(&values_[size_], &value, sizeof value);
        places_[size_] = &values_[size_];
        ++size_;
    }

    std::array<Address, most> values_{};
    std::array<void*, most> places_{};
    std::size_t size_ = 0;
};

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
