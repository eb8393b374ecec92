// SPDX-License-Identifier: Apache-2.0
#include "shape/preparer.h"

#include "executor/executor.h"
#include "shape/accelerators.h"

#include <exception>
#include <optional>
#include <system_error>
#include <utility>

namespace raycontact {

void Preparer::want(const std::shared_ptr<const Shape>& shape) {
    if (!thread_.joinable()) {
        try {
            thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
        } catch (const std::system_error&) {
            return shape->prepare(threads_);
        }
    }
    const std::lock_guard lock(mutex_);
    shapes_.push_back(shape);
    wanted_.notify_one();
}

void Preparer::serve(const std::stop_token& stop) {
    std::optional<Executor> executor;
    for (;;) {
        std::shared_ptr<const Shape> shape;
        {
            std::unique_lock lock(mutex_);
            if (!wanted_.wait(lock, stop, [&] { return !shapes_.empty(); })) return;
            shape = std::move(shapes_.front());
            shapes_.pop_front();
        }
        try {
            if (!executor) executor.emplace(threads_, -1, Executor::Priority::low);
            prepare(*shape, *executor, stop);
        } catch (const std::exception&) {
            // No memory or threads. Steps go on without; they are slower and find the same contacts.
        }
    }
}

} // namespace raycontact
