// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <recording/recording.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact::recording {

/// Which bodies are there in a step, by number. Asked in ascending order, it costs what changes, not a look at every
/// body there ever was; an earlier step begins anew.
class LiveBodies {
public:
    /// Ascending. `events` are in the order in which they happened.
    const std::vector<std::uint32_t>& at(std::uint32_t step, std::span<const BodyEvent> events,
                                         std::span<const Body> bodies) {
        if (step < step_) {
            next_ = 0;
            numbers_.clear();
        }
        step_ = step;
        bool gone = false;
        for (; next_ < events.size() && events[next_].step <= step; ++next_) {
            if (events[next_].kind == BodyEvent::comes)
                numbers_.push_back(events[next_].body); // they count up
            else
                gone = true;
        }
        if (gone) std::erase_if(numbers_, [&](std::uint32_t number) { return !bodies[number].alive(step); });
        return numbers_;
    }

private:
    std::uint32_t step_ = 0;
    std::size_t next_ = 0; ///< event
    std::vector<std::uint32_t> numbers_;
};

} // namespace raycontact::recording
