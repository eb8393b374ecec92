// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace raycontact {

/// With devices "auto" all pairs are on one of two parts: 0, the CPU, or 1, a GPU. This says on which, by the time that
/// steps took on each. It knows no clock and no device: it goes by the numbers that it is given.
///
/// It begins with the CPU. Once that has been at work for about as long as it takes to open a GPU, it tries the other
/// part for a few steps, and stays with the faster one. It tries again where the number of pairs or the time of a step
/// has doubled or halved, but never so often that the trials lose more than a fiftieth of all time; opening the GPU,
/// once, is left out.
class DeviceChoice {
public:
    DeviceChoice();

    /// Where all pairs of the next step are.
    std::size_t part() const { return trying_ ? 1 - best_ : best_; }
    /// A step of part(): of so many pairs, in milliseconds. A step in which nothing was sought is none.
    void record(std::uint64_t pairs, double ms);
    /// Milliseconds that it took to move all pairs to part().
    void record_move(double ms);
    /// A part that no pair can be on. why: the end of text(), as "no GPU".
    void exclude(std::size_t part, const std::string& why);
    /// What was measured is of other settings.
    void forget();

    /// What is chosen, and why: "cpu: 1.2 ms a step, gpu:0 3.41 ms, measured with 7650 pairs". names: of both parts.
    std::string text(const std::array<std::string, 2>& names) const;

private:
    static constexpr unsigned warm_up = 4;   ///< steps that do not count: shapes are copied, lists made, caches filled
    static constexpr std::size_t window = 7; ///< steps whose median counts
    struct Measured {
        std::array<double, 2> ms{}; ///< median of a step, by part
        std::uint64_t pairs = 0;    ///< 0: never measured
    };

    bool is_too_short() const;
    bool has_changed() const;
    void end_trial(double ms);
    void pay();

    std::size_t best_ = 0; ///< of the parts, as far as is known
    bool trying_ = false;  ///< the other one
    std::array<bool, 2> there_{true, true};
    std::string why_not_; ///< of the last exclude()

    std::array<double, window> times_{}; ///< of part(), since warm-up
    std::size_t time_count_ = 0;
    unsigned uncounted_ = warm_up; ///< steps still to come

    double ms_ = 0;           ///< median of the last steps on best_; 0: none yet
    std::uint64_t pairs_ = 0; ///< of the last of these
    Measured compared_;       ///< in the last trial

    double since_trial_ = 0; ///< milliseconds, of all steps
    double wait_;            ///< milliseconds, before the next trial
    double trial_ = 0;       ///< milliseconds, of the one that is on
    unsigned trial_steps_ = 0;
};

} // namespace raycontact
