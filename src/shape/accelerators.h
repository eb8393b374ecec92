// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "shape/shape_data.h"
#include "shape/supports.h"

#include <atomic>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <utility>
#include <vector>

namespace raycontact {

/// What only makes later steps faster: no contact of `standard` or `certified` depends on it. It takes several times as
/// long to make as the shape itself, so it is made when a shape proves to be met again, or by Shape::prepare().
struct Accelerators {
    kernels::ShapeHeader header;              ///< the shape's, with these
    std::vector<kernels::uint> normal_cones;  ///< of the triangle blocks, TRIANGLE_LANES each; empty: none
    std::vector<kernels::uint> outside_cells; ///< a bit for each cell of the outside grid
    std::vector<kernels::uint> clearances;    ///< a ball for each cell of the clearance grid
    Supports supports;

    std::uint64_t bytes() const;
};

/// Null if it was asked to stop.
std::unique_ptr<const Accelerators> build_accelerators(const ShapeData& shape, Executor& executor,
                                                       const std::stop_token& stop);

/// What a shape does not tell of its accelerators; the lists as they have them.
struct SavedAccelerators {
    bool outward = false;
    std::vector<kernels::uint> normal_cones, outside_cells, clearances;
    std::vector<float> reaches; ///< of Supports
};

/// What was saved of this shape's. Null where it does not fit the shape: no number of it leads out of an array.
std::unique_ptr<const Accelerators> restore_accelerators(const ShapeData& shape, SavedAccelerators saved);

/// The accelerators of one shape, made once; read by any thread while another makes them.
class AcceleratorSlot {
public:
    /// Null until they are made.
    const Accelerators* get() const { return ready_.load(std::memory_order_acquire); }
    /// Makes them, unless they are there. Waits for a thread that is at it. False if it was asked to stop.
    bool make(const ShapeData& shape, Executor& executor, const std::stop_token& stop);
    /// Those of a shape that nobody else has yet.
    void set(std::unique_ptr<const Accelerators> made) {
        made_ = std::move(made);
        ready_.store(made_.get(), std::memory_order_release);
    }

private:
    /// The process in which a thread is at it; 0: none. A forked child has its parent's number here and no such thread.
    std::atomic<std::uint64_t> maker_{0};
    std::unique_ptr<const Accelerators> made_;
    std::atomic<const Accelerators*> ready_{nullptr};
};

/// Null until a shape is prepared.
const Accelerators* accelerators_of(const Shape& shape);
/// Shape::prepare() on these threads. False if it was asked to stop.
bool prepare(const Shape& shape, Executor& executor, const std::stop_token& stop);

/// Calls work(i) for each i below `count` on the executor's threads until all are done, or it is asked to stop.
template <class Work>
void run_until(Executor& executor, const std::stop_token& stop, std::size_t count, std::uint32_t grain, Work&& work) {
    executor.each(count, grain, [&](std::uint32_t i) {
        if (!stop.stop_requested()) work(i);
    });
}

} // namespace raycontact
