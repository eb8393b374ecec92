// SPDX-License-Identifier: Apache-2.0
#include "executor/executor.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <optional>

namespace raycontact {

namespace {

class TbbPool : public ThreadPool {
public:
    TbbPool(std::uint32_t threads, bool low_priority)
        : arena_(static_cast<int>(threads), 1,
                 low_priority ? tbb::task_arena::priority::low : tbb::task_arena::priority::normal) {
        if (threads > static_cast<std::uint32_t>(tbb::info::default_concurrency()))
            allowed_.emplace(tbb::global_control::max_allowed_parallelism, threads);
    }

    void wake() override {
        arena_.enqueue([] {});
    }

    void run(std::uint32_t count, std::uint32_t grain, SliceReference slice) override {
        arena_.execute([&] {
            tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count, grain),
                              [&](const tbb::blocked_range<std::uint32_t>& r) { slice(r.begin(), r.end()); });
        });
    }

private:
    // Raises oneTBB's limit, the number of cores, if more threads are wanted.
    std::optional<tbb::global_control> allowed_;
    tbb::task_arena arena_;
};

} // namespace

std::unique_ptr<ThreadPool> make_thread_pool(std::uint32_t threads, bool low_priority) {
    return std::make_unique<TbbPool>(threads, low_priority);
}

} // namespace raycontact
