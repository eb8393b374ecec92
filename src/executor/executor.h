// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "interruption.h"
#include "platform/system.h"

#include <raycontact/execution.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

namespace raycontact {

/// Refers to a caller's lambda over [begin, end); std::function would allocate one every step.
struct SliceReference {
    const void* function;
    void (*call)(const void*, std::uint32_t, std::uint32_t);
    std::uint32_t piece;           ///< of a slice, done before it is asked again whether the work is to end
    const std::atomic<bool>* flag; ///< of the caller's thread, which counts on each
    /// Calls it under FloatEnvironment. Throws Interrupted.
    void operator()(std::uint32_t begin, std::uint32_t end) const;
};

/// Two threads or more: a user's, oneTBB's, or plain std::thread where a sanitizer must see every lock
/// (RAYCONTACT_EXECUTOR=std).
class ThreadPool {
public:
    virtual ~ThreadPool() = default;
    virtual void wake() = 0;
    virtual void run(std::uint32_t count, std::uint32_t grain, SliceReference slice) = 0;
};
/// low: gets threads that no other pool has work for (oneTBB only).
std::unique_ptr<ThreadPool> make_thread_pool(std::uint32_t threads, bool low_priority);

/// Binds the calling thread to one core, if that is >= 0, for as long as it lives. A second one for the same core costs
/// nothing.
class Pin {
public:
    explicit Pin(int core);
    ~Pin();
    Pin(const Pin&) = delete;
    Pin& operator=(const Pin&) = delete;

private:
    platform::CoreSet before_;
    int outer_ = -1;
    bool pinned_ = false;
};

/// That work on so many triangles is given: one for few, which are done before others wake, else as many as told.
/// Throws InputError as Executor does.
std::uint32_t threads_for(std::size_t triangles, std::uint32_t threads);

/// Runs slices of an index range on a fixed number of threads. Which thread takes a slice never decides a result.
class Executor {
public:
    enum class Priority { normal, low };
    /// threads 0: one per core this process may use. Throws InputError for more than 1024. core >= 0: one thread,
    /// pinned to that core (the system's number, see usable_core). low: others' work comes first. tasks: whose threads
    /// they are.
    explicit Executor(std::uint32_t threads, int core = -1, Priority priority = Priority::normal,
                      const TaskSystem& tasks = {});

    std::uint32_t threads() const { return threads_; }
    /// That each of so many tasks, run by this, may use itself: one, unless they are too few for all threads.
    std::uint32_t threads_of_each(std::size_t tasks) const { return tasks < threads_ ? threads_ : 1; }
    /// The one that all work is pinned to; -1: none.
    int core() const { return core_; }
    /// Begins to wake the threads, which takes a while, and does not wait for them: work is about to come.
    void wake() {
        if (pool_) pool_->wake();
    }
    /// Calls slice(begin, end) over [0, count) in pieces of at least `grain`, under FloatEnvironment, and returns when
    /// all are done. The first exception of a slice is thrown here; Interrupted where the work is to end.
    template <typename Slice>
    void run(std::uint32_t count, std::uint32_t grain, Slice&& slice) {
        using Function = std::remove_reference_t<Slice>;
        run_slices(count, grain,
                   {&slice,
                    [](const void* function, std::uint32_t begin, std::uint32_t end) {
                        (*static_cast<const Function*>(function))(begin, end);
                    },
                    std::max(16 * grain, count / 256), interruption_flag});
    }
    /// Calls work(i) for each i below `count`.
    template <typename Work>
    void each(std::size_t count, std::uint32_t grain, Work&& work) {
        run(static_cast<std::uint32_t>(count), grain, [&](std::uint32_t begin, std::uint32_t end) {
            const InterruptionCheck check;
            for (std::uint32_t i = begin; i < end; ++i) {
                check();
                work(i);
            }
        });
    }

private:
    void run_slices(std::uint32_t count, std::uint32_t grain, SliceReference slice);

    std::uint32_t threads_;
    int core_;
    std::unique_ptr<ThreadPool> pool_; ///< null for one thread
};

/// How many cores this process may use, and the system's number of the k-th of them (-1: there are fewer).
std::uint32_t usable_cores();
int usable_core(std::uint32_t k);

} // namespace raycontact
