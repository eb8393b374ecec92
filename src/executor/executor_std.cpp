// SPDX-License-Identifier: Apache-2.0
#include "executor/executor.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace raycontact {

namespace {

// All threads begin and end each run together: slow and plain, so that ThreadSanitizer sees all of it. No std::barrier:
// with g++ 12 for Windows its threads now and then sleep for ever.
class StdPool : public ThreadPool {
public:
    explicit StdPool(std::uint32_t threads) {
        try {
            for (std::uint32_t i = 1; i < threads; ++i) helpers_.emplace_back([this] { serve(); });
        } catch (...) {
            end(); // or those there are would be waited for for ever
            throw;
        }
    }
    ~StdPool() override { end(); }

    void wake() override {} // these threads wait for work itself

    void run(std::uint32_t count, std::uint32_t grain, SliceReference slice) override {
        {
            const std::lock_guard lock(mutex_);
            slice_ = slice;
            count_ = count;
            step_ = std::max<std::uint64_t>(grain, count / (4 * (helpers_.size() + 1)) + 1);
            next_ = 0;
            busy_ = helpers_.size();
            ++run_;
        }
        begin_.notify_all();
        help();
        std::unique_lock lock(mutex_);
        end_.wait(lock, [this] { return busy_ == 0; });
        if (const std::exception_ptr error = std::exchange(error_, nullptr)) std::rethrow_exception(error);
    }

private:
    void end() {
        {
            const std::lock_guard lock(mutex_);
            stop_ = true;
        }
        begin_.notify_all();
    }

    void serve() {
        for (std::uint64_t done = 0;; ++done) {
            {
                std::unique_lock lock(mutex_);
                begin_.wait(lock, [&] { return stop_ || run_ != done; });
                if (stop_) return;
            }
            help();
            const std::lock_guard lock(mutex_);
            if (--busy_ == 0) end_.notify_one();
        }
    }

    void help() {
        for (;;) {
            const std::uint64_t begin = next_.fetch_add(step_), end = std::min(begin + step_, count_);
            if (begin >= count_) return;
            try {
                slice_(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end));
            } catch (...) {
                const std::lock_guard lock(mutex_);
                if (!error_) error_ = std::current_exception();
            }
        }
    }

    std::mutex mutex_; ///< of all but next_
    std::condition_variable begin_, end_;
    SliceReference slice_{};
    std::uint64_t count_ = 0, step_ = 1; ///< 64 bits: next_ may pass 2^32
    std::atomic<std::uint64_t> next_{0};
    std::size_t busy_ = 0; ///< helpers that have not ended this run
    std::uint64_t run_ = 0;
    std::exception_ptr error_;
    bool stop_ = false;
    std::vector<std::jthread> helpers_; ///< last, to be joined first
};

} // namespace

std::unique_ptr<ThreadPool> make_thread_pool(std::uint32_t threads, bool /*low_priority*/) {
    return std::make_unique<StdPool>(threads);
}

} // namespace raycontact
