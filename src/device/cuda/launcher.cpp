// SPDX-License-Identifier: Apache-2.0
#include "device/cuda/launcher.h"

namespace raycontact::cuda {

namespace {

constexpr std::size_t items_in_group = 128;
// More than a multiprocessor runs at once, so that the last ones to end leave little idle. Other numbers: not tried.
constexpr std::size_t groups_of_multiprocessor = 32;

} // namespace

Launcher::Launcher(std::shared_ptr<const Context> context, std::uint32_t multiprocessors)
    : context_(std::move(context)), most_groups_(groups_of_multiprocessor * std::max<std::size_t>(multiprocessors, 1)) {
}

void Launcher::over_items(FunctionHandle kernel, const char* name, std::size_t most, Arguments& arguments) {
    in_groups(kernel, name, items_in_group,
              std::clamp<std::size_t>((most + items_in_group - 1) / items_in_group, 1, most_groups_), arguments);
}

void Launcher::in_groups(FunctionHandle kernel, const char* name, std::size_t group_size, std::size_t groups,
                         Arguments& arguments) {
    if (started_ == timed_.size()) timed_.push_back({make_event(context_, true), make_event(context_, true)});
    const Timed& timed = timed_[started_];
    check(driver().cuEventRecord(timed.begin.get(), context_->stream()), "cuEventRecord");
    check(driver().cuLaunchKernel(kernel, static_cast<unsigned>(groups), 1, 1, static_cast<unsigned>(group_size), 1, 1,
                                  0, context_->stream(), arguments.places(), nullptr),
          name);
    check(driver().cuEventRecord(timed.end.get(), context_->stream()), "cuEventRecord");
    ++started_;
}

void Launcher::finish() {
    check(driver().cuStreamSynchronize(context_->stream()), "cuStreamSynchronize");
    for (; started_ > 0; --started_) {
        const Timed& timed = timed_[started_ - 1];
        float milliseconds = 0;
        check(driver().cuEventElapsedTime(&milliseconds, timed.begin.get(), timed.end.get()), "cuEventElapsedTime");
        busy_ms_ += static_cast<double>(milliseconds);
    }
}

} // namespace raycontact::cuda
