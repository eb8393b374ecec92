// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/shape.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>

namespace raycontact {

/// Prepares shapes beside the steps of a scene, on a thread of its own that uses all others while they are idle.
class Preparer {
public:
    /// threads 0: one per core.
    explicit Preparer(std::uint32_t threads) : threads_(threads) {}
    ~Preparer() { forget_if_forked(); }
    Preparer(const Preparer&) = delete;
    Preparer& operator=(const Preparer&) = delete;

    /// Returns at once; Shape::is_prepared() tells when it is done. Prepares the shape here where no thread can be
    /// made.
    void want(const std::shared_ptr<const Shape>& shape);

private:
    /// What the thread works on.
    struct Work {
        explicit Work(std::uint32_t threads);
        void serve(const std::stop_token& stop, std::uint32_t threads);
        std::shared_ptr<const Shape> next();
        void call();

        std::uint64_t process; ///< that made the thread
        std::mutex mutex;
        std::deque<std::shared_ptr<const Shape>> shapes; ///< still to be prepared
        std::atomic<std::uint32_t> calls{0};             ///< the thread sleeps between them
        std::jthread thread;                             ///< last, to be joined first
    };

    /// A forked child has no such thread: it cannot be joined.
    void forget_if_forked();

    std::uint32_t threads_;
    std::unique_ptr<Work> work_; ///< none before the first shape
};

} // namespace raycontact
