// SPDX-License-Identifier: Apache-2.0
#include "batch.h"
#include "without_gil.h"

#include <raycontact/error.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <limits>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace raycontact::python {

namespace {

/// Items that are handed out, and the first failure.
class Batch {
public:
    Batch(std::size_t count, std::size_t block, const std::function<void(std::size_t)>& work)
        : count_(count), block_(block), work_(work) {}

    /// Does one block of items. False: none is left, or one failed.
    bool work_on_block() {
        // A block once taken is done to its end, so that the lowest item to fail is the same in each run.
        if (stop_ || is_ending()) return false;
        const std::size_t begin = next_.fetch_add(block_);
        if (begin >= count_) return false;
        for (std::size_t i = begin; i < std::min(count_, begin + block_); ++i) {
            try {
                work_(i);
            } catch (...) {
                fail(i, std::current_exception());
                return false; // those behind it cannot be lower
            }
        }
        return true;
    }

    void stop() { stop_ = true; }
    /// The item that failed first in order, of those that were begun.
    std::size_t failed() const { return failed_; }
    const std::exception_ptr& failure() const { return failure_; }

private:
    void fail(std::size_t i, std::exception_ptr failure) {
        const std::lock_guard lock(mutex_);
        stop_ = true;
        if (i >= failed_) return;
        failed_ = i;
        failure_ = std::move(failure);
    }

    std::size_t count_, block_;
    const std::function<void(std::size_t)>& work_;
    std::atomic<std::size_t> next_ = 0;
    std::atomic<bool> stop_ = false;
    std::mutex mutex_;
    std::size_t failed_ = std::numeric_limits<std::size_t>::max();
    std::exception_ptr failure_;
};

} // namespace

void for_each_item(std::size_t count, std::uint32_t threads, const std::string& item,
                   const std::function<void(std::size_t)>& work) {
    using Clock = std::chrono::steady_clock;
    constexpr std::uint32_t most_threads = 1024; // as of shapes and scenes
    if (threads > most_threads)
        throw InputError("threads: " + std::to_string(threads) + " is too many; give at most 1024");
    if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
    // Blocks small enough that threads end together.
    Batch batch(count, std::clamp<std::size_t>(count / (16 * std::size_t{threads}), 1, 64), work);
    {
        WithoutGil without_gil;
        std::vector<std::jthread> helpers; // joined before the GIL is taken again
        for (std::size_t i = 1; i < std::min<std::size_t>(threads, count); ++i) {
            try {
                helpers.emplace_back([&batch, &without_gil] {
                    const Interruptible interruptible(without_gil.flag());
                    while (batch.work_on_block()) {
                    }
                });
            } catch (const std::system_error&) {
                break; // fewer threads do the same
            }
        }
        for (auto looked = Clock::now(); batch.work_on_block();) {
            if (Clock::now() - looked < std::chrono::milliseconds(50)) continue;
            try {
                without_gil.check_signals();
            } catch (...) {
                batch.stop();
                throw;
            }
            looked = Clock::now();
        }
    }
    if (!batch.failure()) return;
    try {
        std::rethrow_exception(batch.failure());
    } catch (const InputError& error) {
        if (count == 1) throw;
        throw InputError(item + " " + std::to_string(batch.failed()) + ": " + error.what());
    }
}

} // namespace raycontact::python
