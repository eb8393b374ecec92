// SPDX-License-Identifier: Apache-2.0
#include "executor/executor.h"
#include "executor/float_environment.h"
#include "executor/pin.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace raycontact {

// A pool that hands out slices under one lock: slow and plain, so that ThreadSanitizer sees all of it.
struct Executor::State {
    std::uint32_t threads = 1;
    int core = -1;
    std::vector<std::thread> pool;
    std::mutex mutex;
    std::condition_variable work, done;
    const SliceReference* slice = nullptr;
    std::uint32_t next = 0, count = 0, step = 1, active = 0;
    std::exception_ptr error;
    bool stop = false;

    void help(std::unique_lock<std::mutex>& lock) {
        while (next < count) {
            const std::uint32_t begin = next;
            const std::uint32_t end = count - begin < step ? count : begin + step;
            next = end;
            ++active;
            const auto* run = slice;
            lock.unlock();
            std::exception_ptr thrown;
            try {
                const FloatEnvironment environment;
                (*run)(begin, end);
            } catch (...) {
                thrown = std::current_exception();
            }
            lock.lock();
            if (thrown && !error) error = thrown;
            --active;
        }
        if (active == 0) done.notify_all();
    }

    void serve() {
        std::unique_lock lock(mutex);
        for (;;) {
            work.wait(lock, [&] { return stop || next < count; });
            if (stop) return;
            help(lock);
        }
    }
};

Executor::Executor(std::uint32_t threads, int core) : state_(std::make_unique<State>()) {
    state_->threads = core >= 0 ? 1 : (threads > 0 ? threads : usable_cores());
    state_->core = core;
    for (std::uint32_t i = 1; i < state_->threads; ++i) state_->pool.emplace_back([this] { state_->serve(); });
}

Executor::~Executor() {
    {
        const std::lock_guard lock(state_->mutex);
        state_->stop = true;
    }
    state_->work.notify_all();
    for (std::thread& thread : state_->pool) thread.join();
}

std::uint32_t Executor::threads() const {
    return state_->threads;
}

// These threads wait for work itself.
void Executor::wake() {}

void Executor::run_slices(std::uint32_t count, std::uint32_t grain, SliceReference slice) {
    if (count == 0) return;
    Pin pin;
    if (state_->core >= 0) pin.enter(state_->core);
    std::exception_ptr error;
    {
        std::unique_lock lock(state_->mutex);
        state_->slice = &slice;
        state_->next = 0;
        state_->count = count;
        state_->step = std::max(grain, count / (4 * state_->threads) + 1);
        state_->error = nullptr;
        state_->work.notify_all();
        state_->help(lock);
        state_->done.wait(lock, [&] { return state_->active == 0; });
        state_->count = state_->next = 0;
        error = state_->error;
    }
    if (state_->core >= 0) pin.leave();
    if (error) std::rethrow_exception(error);
}

} // namespace raycontact
