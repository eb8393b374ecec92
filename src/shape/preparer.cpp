// SPDX-License-Identifier: Apache-2.0
#include "shape/preparer.h"

#include "executor/executor.h"
#include "platform/system.h"
#include "shape/accelerators.h"

#include <exception>
#include <optional>
#include <system_error>
#include <utility>

namespace raycontact {

Preparer::Work::Work(std::uint32_t threads)
    : process(platform::process_id()), thread([this, threads](const std::stop_token& stop) { serve(stop, threads); }) {}

void Preparer::forget_if_forked() {
    if (work_ && work_->process != platform::process_id()) static_cast<void>(work_.release());
}

void Preparer::want(const std::shared_ptr<const Shape>& shape) {
    forget_if_forked();
    if (!work_) {
        try {
            work_ = std::make_unique<Work>(threads_);
        } catch (const std::system_error&) {
            return shape->prepare(threads_);
        }
    }
    {
        const std::lock_guard lock(work_->mutex);
        work_->shapes.push_back(shape);
    }
    work_->call();
}

void Preparer::Work::call() {
    ++calls;
    calls.notify_one();
}

std::shared_ptr<const Shape> Preparer::Work::next() {
    const std::lock_guard lock(mutex);
    if (shapes.empty()) return nullptr;
    std::shared_ptr<const Shape> shape = std::move(shapes.front());
    shapes.pop_front();
    return shape;
}

void Preparer::Work::serve(const std::stop_token& stop, std::uint32_t threads) {
    const std::stop_callback call_to_end(stop, [this] { call(); });
    std::optional<Executor> executor;
    while (!stop.stop_requested()) {
        const std::uint32_t seen = calls;
        const std::shared_ptr<const Shape> shape = next();
        if (!shape) {
            if (!stop.stop_requested()) calls.wait(seen);
            continue;
        }
        try {
            if (!executor) executor.emplace(threads, -1, Executor::Priority::low);
            prepare(*shape, *executor, stop);
        } catch (const std::exception&) {
            // No memory or threads. Steps go on without; they are slower and find the same contacts.
        }
    }
}

} // namespace raycontact
