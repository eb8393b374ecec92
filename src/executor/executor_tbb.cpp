// SPDX-License-Identifier: Apache-2.0
#include "executor/executor.h"
#include "executor/float_environment.h"
#include "executor/pin.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_scheduler_observer.h>

namespace raycontact {

namespace {

// Pins whatever thread enters the arena, and lets it go again.
class Pinner : public tbb::task_scheduler_observer {
public:
    Pinner(tbb::task_arena& arena, int core) : tbb::task_scheduler_observer(arena), core_(core) { observe(true); }
    ~Pinner() override { observe(false); }
    void on_scheduler_entry(bool) override { pinned_.enter(core_); }
    void on_scheduler_exit(bool) override { pinned_.leave(); }

private:
    int core_;
    Pin pinned_;
};

} // namespace

struct Executor::State {
    std::uint32_t threads;
    // oneTBB keeps to the number of cores unless told otherwise; whoever asks for more threads gets them.
    std::unique_ptr<tbb::global_control> allowed;
    tbb::task_arena arena;
    std::unique_ptr<Pinner> pinner;
    explicit State(std::uint32_t count) : threads(count), arena(static_cast<int>(count)) {
        if (count > static_cast<std::uint32_t>(tbb::info::default_concurrency()))
            allowed = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, count);
    }
};

Executor::Executor(std::uint32_t threads, int core)
    : state_(std::make_unique<State>(core >= 0 ? 1 : (threads > 0 ? threads : usable_cores()))) {
    if (core >= 0) state_->pinner = std::make_unique<Pinner>(state_->arena, core);
}

Executor::~Executor() = default;

std::uint32_t Executor::threads() const {
    return state_->threads;
}

void Executor::wake() {
    if (state_->threads > 1) state_->arena.enqueue([] {});
}

void Executor::run_slices(std::uint32_t count, std::uint32_t grain, SliceReference slice) {
    if (count == 0) return;
    if (!state_->pinner && (state_->threads == 1 || count <= grain)) {
        const FloatEnvironment environment;
        slice(0, count);
        return;
    }
    state_->arena.execute([&] {
        tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count, grain),
                          [&](const tbb::blocked_range<std::uint32_t>& r) {
                              const FloatEnvironment environment;
                              slice(r.begin(), r.end());
                          });
    });
}

} // namespace raycontact
