// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/shape.h>

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>

namespace raycontact {

/// Prepares shapes beside the steps of a scene, on a thread of its own that uses all others while they are idle.
class Preparer {
public:
    /// threads 0: one per core.
    explicit Preparer(std::uint32_t threads) : threads_(threads) {}

    /// Returns at once; Shape::is_prepared() tells when it is done. Prepares the shape here where no thread can be
    /// made.
    void want(const std::shared_ptr<const Shape>& shape);

private:
    void serve(const std::stop_token& stop);

    std::uint32_t threads_;
    std::mutex mutex_;
    std::condition_variable_any wanted_;
    std::deque<std::shared_ptr<const Shape>> shapes_; ///< still to be prepared
    std::jthread thread_;                             ///< last, to be joined first; none before the first shape
};

} // namespace raycontact
