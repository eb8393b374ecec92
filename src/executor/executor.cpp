// SPDX-License-Identifier: Apache-2.0
#include "executor/executor.h"
#include "executor/float_environment.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace raycontact {

namespace {
thread_local int pinned_to = -1;
} // namespace

Pin::Pin(int core) {
    if (core < 0 || core == pinned_to || sched_getaffinity(0, sizeof before_, &before_) != 0) return;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(core, &one);
    pinned_ = sched_setaffinity(0, sizeof one, &one) == 0;
    if (pinned_) outer_ = std::exchange(pinned_to, core);
}

Pin::~Pin() {
    if (!pinned_) return;
    sched_setaffinity(0, sizeof before_, &before_);
    pinned_to = outer_;
}

void SliceReference::operator()(std::uint32_t begin, std::uint32_t end) const {
    const FloatEnvironment environment;
    call(function, begin, end);
}

Executor::Executor(std::uint32_t threads, int core, Priority priority)
    : threads_(core >= 0 ? 1 : (threads > 0 ? threads : usable_cores())), core_(core),
      pool_(threads_ > 1 ? make_thread_pool(threads_, priority == Priority::low) : nullptr) {}

void Executor::run_slices(std::uint32_t count, std::uint32_t grain, SliceReference slice) {
    if (count == 0) return;
    if (pool_ && count > grain) return pool_->run(count, grain, slice);
    const Pin pin(core_);
    slice(0, count);
}

std::uint32_t usable_cores() {
    cpu_set_t allowed;
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) return std::max(1, CPU_COUNT(&allowed));
    return std::max(1u, std::thread::hardware_concurrency());
}

int usable_core(std::uint32_t k) {
    cpu_set_t allowed;
    if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return static_cast<int>(k);
    for (int core = 0; core < CPU_SETSIZE; ++core)
        if (CPU_ISSET(core, &allowed) && k-- == 0) return core;
    return -1;
}

} // namespace raycontact
