// SPDX-License-Identifier: Apache-2.0
#include "executor/executor.h"
#include "executor/float_environment.h"

#include <raycontact/error.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

namespace raycontact {

namespace {
thread_local int pinned_to = -1;
constexpr std::uint32_t most_threads = 1024;
constexpr std::size_t few_triangles = 512;

void check(std::uint32_t threads) {
    if (threads > most_threads)
        throw InputError("threads: " + std::to_string(threads) + " is too many; give at most "
                         + std::to_string(most_threads));
}

/// The threads of a TaskSystem.
class TaskPool : public ThreadPool {
public:
    TaskPool(std::uint32_t threads, const TaskSystem& tasks) : most_(4 * std::uint64_t{threads}), tasks_(tasks) {}

    void wake() override {} // they are the user's

    void run(std::uint32_t count, std::uint32_t grain, SliceReference slice) override {
        Work work{slice, count, std::max<std::uint64_t>(std::max(grain, 1u), (count + most_ - 1) / most_), {}, {}, {}};
        const auto jobs = static_cast<std::uint32_t>((count + work.step - 1) / work.step);
        tasks_.run(
            tasks_.user, jobs, [](void* data, std::uint32_t i) { static_cast<Work*>(data)->run(i); }, &work);
        if (work.done != jobs)
            throw std::logic_error("Execution::tasks: run() returned after " + std::to_string(work.done.load()) + " of "
                                   + std::to_string(jobs) + " jobs");
        if (work.error) std::rethrow_exception(work.error);
    }

private:
    struct Work {
        SliceReference slice;
        std::uint64_t count, step;
        std::atomic<std::uint32_t> done;
        std::mutex mutex; ///< of error
        std::exception_ptr error;

        void run(std::uint32_t i) {
            const std::uint64_t begin = i * step, end = std::min(begin + step, count);
            try {
                slice(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end));
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!error) error = std::current_exception();
            }
            ++done;
        }
    };
    std::uint64_t most_; ///< jobs of one run
    TaskSystem tasks_;
};

std::uint32_t number_of(std::uint32_t threads, int core) {
    check(threads);
    if (core >= 0) return 1;
    return threads > 0 ? threads : usable_cores();
}
} // namespace

Pin::Pin(int core) {
    const auto number = static_cast<std::size_t>(core);
    if (core < 0 || core == pinned_to || number >= before_.size()) return;
    before_ = platform::thread_cores();
    if (before_.none()) return;
    pinned_ = platform::set_thread_cores(platform::CoreSet().set(number));
    if (pinned_) outer_ = std::exchange(pinned_to, core);
}

Pin::~Pin() {
    if (!pinned_) return;
    platform::set_thread_cores(before_);
    pinned_to = outer_;
}

void SliceReference::operator()(std::uint32_t begin, std::uint32_t end) const {
    const FloatEnvironment environment;
    const Interruptible interruptible(flag);
    if (flag == nullptr) return call(function, begin, end);
    for (const InterruptionCheck check; begin < end; begin += std::min(piece, end - begin)) {
        check();
        call(function, begin, begin + std::min(piece, end - begin));
    }
}

Executor::Executor(std::uint32_t threads, int core, Priority priority, const TaskSystem& tasks)
    : threads_(number_of(threads, core)), core_(core) {
    if (threads_ == 1) return;
    if (tasks.run != nullptr)
        pool_ = std::make_unique<TaskPool>(threads_, tasks);
    else
        pool_ = make_thread_pool(threads_, priority == Priority::low);
}

void Executor::run_slices(std::uint32_t count, std::uint32_t grain, SliceReference slice) {
    if (count == 0) return;
    if (pool_ && count > grain) return pool_->run(count, grain, slice);
    const Pin pin(core_);
    slice(0, count);
}

std::uint32_t threads_for(std::size_t triangles, std::uint32_t threads) {
    check(threads);
    return triangles < few_triangles ? 1 : threads;
}

std::uint32_t usable_cores() {
    if (const auto cores = platform::thread_cores().count(); cores > 0) return static_cast<std::uint32_t>(cores);
    return std::max(1u, std::thread::hardware_concurrency());
}

int usable_core(std::uint32_t k) {
    const platform::CoreSet allowed = platform::thread_cores();
    if (allowed.none()) return static_cast<int>(k);
    for (std::size_t core = 0; core < allowed.size(); ++core)
        if (allowed[core] && k-- == 0) return static_cast<int>(core);
    return -1;
}

} // namespace raycontact
