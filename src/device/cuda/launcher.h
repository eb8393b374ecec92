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
    Launcher(std::shared_ptr<const Context> context, std::uint32_t multiprocessors)
        : context_(std::move(context)),
          most_groups_(groups_of_multiprocessor * std::max<std::size_t>(multiprocessors, 1)) {}

    /// Starts as many threads as the device can use, and no more than there may be items.
    void over_items(FunctionHandle kernel, const char* name, std::size_t most, Arguments& arguments) {
        in_groups(kernel, name, items_in_group,
                  std::clamp<std::size_t>((most + items_in_group - 1) / items_in_group, 1, most_groups_), arguments);
    }
    void in_groups(FunctionHandle kernel, const char* name, std::size_t group_size, std::size_t groups,
                   Arguments& arguments) {
        if (started_ == timed_.size()) timed_.push_back({make_event(context_, true), make_event(context_, true)});
        const Timed& timed = timed_[started_];
        check(driver().cuEventRecord(timed.begin.get(), context_->stream()), "cuEventRecord");
        check(driver().cuLaunchKernel(kernel, static_cast<unsigned>(groups), 1, 1, static_cast<unsigned>(group_size), 1,
                                      1, 0, context_->stream(), arguments.places(), nullptr),
              name);
        check(driver().cuEventRecord(timed.end.get(), context_->stream()), "cuEventRecord");
        ++started_;
    }

    /// Waits for everything that was started.
    void finish() {
        check(driver().cuStreamSynchronize(context_->stream()), "cuStreamSynchronize");
        for (; started_ > 0; --started_) {
            const Timed& timed = timed_[started_ - 1];
            float milliseconds = 0;
            check(driver().cuEventElapsedTime(&milliseconds, timed.begin.get(), timed.end.get()), "cuEventElapsedTime");
            busy_ms_ += static_cast<double>(milliseconds);
        }
    }
    double busy_ms() const { return busy_ms_; }

private:
    static constexpr std::size_t items_in_group = 128;
    // More than a multiprocessor runs at once, so that the last ones to end leave little idle. Other numbers: not
    // tried.
    static constexpr std::size_t groups_of_multiprocessor = 32;

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
