// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "narrow_phase.h"

#include <bench/peers/work.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace raycontact::bench {

/// Steps of a work through a narrow phase with a device of our choice, the work's bodies and pairs repeated. Copies lie
/// in the same place and meet nobody but their own.
class Replayer {
public:
    Replayer(const Work& work, std::uint32_t copies, const Settings& settings, OpenDevice opened);

    /// Keeps nothing, as if the bodies had never moved. The arrays have the size of the first step then.
    void rest(const Settings& settings);
    /// Poses set, contacts found.
    void step(std::size_t k);

    std::span<const Contact> contacts() const { return narrow_.contacts().all(); }
    const StepStats& stats() const { return stats_; }
    double step_us() const { return step_us_; } ///< of the last step, wall clock

private:
    const Work& work_;
    std::uint32_t copies_;
    NarrowPhase narrow_;
    SlotChanges moved_;
    std::vector<PlacedBody> bodies_;
    std::vector<SlotPair> listed_; ///< of the step
    OpenPairs pairs_;
    StepStats stats_;
    double step_us_ = 0;
};

} // namespace raycontact::bench
