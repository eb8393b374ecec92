// SPDX-License-Identifier: Apache-2.0
#include "executor/executor.h"

#include <algorithm>
#include <atomic>
#include <barrier>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace raycontact {

namespace {

// All threads begin and end each run together: slow and plain, so that ThreadSanitizer sees all of it.
class StdPool : public ThreadPool {
public:
    explicit StdPool(std::uint32_t threads) : begin_(threads), end_(threads) {
        for (std::uint32_t i = 1; i < threads; ++i) helpers_.emplace_back([this] { serve(); });
    }
    ~StdPool() override {
        stop_ = true;
        begin_.arrive_and_wait();
    }

    void wake() override {} // these threads wait for work itself

    void run(std::uint32_t count, std::uint32_t grain, SliceReference slice) override {
        slice_ = slice;
        count_ = count;
        step_ = std::max<std::uint64_t>(grain, count / (4 * (helpers_.size() + 1)) + 1);
        next_ = 0;
        begin_.arrive_and_wait();
        help();
        end_.arrive_and_wait();
        if (const std::exception_ptr error = std::exchange(error_, nullptr)) std::rethrow_exception(error);
    }

private:
    void serve() {
        for (;;) {
            begin_.arrive_and_wait();
            if (stop_) return;
            help();
            end_.arrive_and_wait();
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

    std::barrier<> begin_, end_;
    SliceReference slice_{};
    std::uint64_t count_ = 0, step_ = 1; ///< 64 bits: next_ may pass 2^32
    std::atomic<std::uint64_t> next_{0};
    std::mutex mutex_; ///< of error_
    std::exception_ptr error_;
    bool stop_ = false;
    std::vector<std::jthread> helpers_; ///< last, to be joined first
};

} // namespace

std::unique_ptr<ThreadPool> make_thread_pool(std::uint32_t threads, bool /*low_priority*/) {
    return std::make_unique<StdPool>(threads);
}

} // namespace raycontact
