// SPDX-License-Identifier: Apache-2.0
#include "shape/accelerators.h"

#include "executor/float_environment.h"
#include "interruption.h"
#include "mesh/check.h"
#include "platform/system.h"
#include "shape/build.h"

#include <chrono>
#include <thread>
#include <utility>

namespace raycontact {

namespace {

/// Gives the turn to make them back, also where that fails.
class Turn {
public:
    explicit Turn(std::atomic<std::uint64_t>& maker) : maker_(maker) {}
    ~Turn() {
        maker_ = 0;
        maker_.notify_all();
    }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

private:
    std::atomic<std::uint64_t>& maker_;
};

void set_places(Accelerators& made) {
    made.header.outside_cells = host_place(made.outside_cells);
    made.header.clearances = host_place(made.clearances);
    made.header.normal_cones = host_place(made.normal_cones);
}

} // namespace

std::uint64_t Accelerators::bytes() const {
    const auto bytes = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    return sizeof *this + bytes(normal_cones) + bytes(outside_cells) + bytes(clearances) + supports.bytes();
}

std::unique_ptr<const Accelerators> build_accelerators(const ShapeData& shape, Executor& executor,
                                                       const std::stop_token& stop) {
    const FloatEnvironment environment;
    auto made = std::make_unique<Accelerators>();
    made->header = shape.header;
    if (!shape.mesh.report.checked && shape.header.closed != 0)
        made->header.outward = measured_report(shape.mesh, executor).outward ? 1 : 0;
    build_outside_grid(shape, *made, stop);
    if (stop.stop_requested()) return nullptr;
    build_clearance_grid(shape, *made, executor, stop);
    build_normal_cones(shape, *made, executor, stop);
    made->supports = Supports(shape, executor, stop);
    if (stop.stop_requested()) return nullptr;
    set_places(*made);
    return made;
}

std::unique_ptr<const Accelerators> restore_accelerators(const ShapeData& shape, SavedAccelerators saved) {
    const FloatEnvironment environment;
    auto made = std::make_unique<Accelerators>();
    made->header = shape.header;
    // Only of an unchecked mesh is it not known before (build_accelerators()).
    const bool outward = shape.header.outward != 0;
    if (saved.outward != outward && (shape.mesh.report.checked || shape.header.closed == 0)) return nullptr;
    made->header.outward = saved.outward ? 1 : 0;
    made->supports = Supports(std::move(saved.reaches));
    if (!restore_outside_grid(shape, *made, std::move(saved.outside_cells))
        || !restore_clearance_grid(shape, *made, std::move(saved.clearances))
        || !restore_normal_cones(shape, *made, std::move(saved.normal_cones)) || made->supports.reaches().empty())
        return nullptr;
    set_places(*made);
    return made;
}

bool AcceleratorSlot::make(const ShapeData& shape, Executor& executor, const std::stop_token& stop) {
    const std::uint64_t here = platform::process_id();
    for (std::uint64_t maker = 0; get() == nullptr;) {
        if (maker == here) {
            // Also by a thread that nobody interrupts.
            const InterruptionCheck check;
            while (check.can_end() && maker_ == here) {
                check();
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
            maker_.wait(here);
            maker = maker_;
        } else if (maker_.compare_exchange_strong(maker, here)) {
            const Turn turn(maker_);
            if (get() != nullptr) return true; // another thread's turn was just before
            made_ = build_accelerators(shape, executor, stop);
            ready_.store(made_.get(), std::memory_order_release);
            return made_ != nullptr;
        }
    }
    return true;
}

const Accelerators* accelerators_of(const Shape& shape) {
    return shape.data().accelerators->get();
}

bool prepare(const Shape& shape, Executor& executor, const std::stop_token& stop) {
    return shape.data().accelerators->make(shape.data(), executor, stop);
}

} // namespace raycontact
