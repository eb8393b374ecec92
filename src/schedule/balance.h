// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/scene.h>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace raycontact {

/// What the counts of a step come to, in units of a pair at rest.
double load_of(const StepStats& stats);

/// How much the parts have to do, what a unit of load costs on each, and when pairs should move.
class Balance {
public:
    /// costs: of a unit on each part, as far as is known before any step; only their ratios matter.
    Balance(Schedule schedule, std::span<const double> costs);

    /// One more part, the last.
    void add(double cost) { seats_.push_back({.cost = cost}); }
    /// New pairs go to this part alone, and none moves by itself, until it is dropped.
    void choose(std::size_t part) { chosen_ = part; }

    /// The part with the least load, or the chosen one, which gets one pair more.
    std::size_t part_for_new_pair();
    /// What a part did in a step, by load_of() and by the clock.
    void record(std::size_t part, double load, double ms);
    /// Once all parts have been recorded. pair_count: of them all.
    void end_step(std::size_t pair_count);
    /// No pair goes to this part any more.
    void drop(std::size_t part);

    /// A share of one part's load that should go to another.
    struct Move {
        std::size_t from = 0, to = 0;
        double share = 0;
    };
    /// Something if the most loaded part has had more than 1.1 of the mean for 8 steps, still has, and moving pays off.
    /// Several moves may follow one another in a step.
    std::optional<Move> next_move() const;
    /// A move as it was carried out, and what it took by the clock.
    void record_move(const Move& move, double ms);

private:
    struct Seat {
        bool there = true;
        double cost = 1;     ///< of a unit: set, or milliseconds as measured
        double measured = 0; ///< milliseconds a unit, smoothed; 0: never yet
        double load = 0;     ///< of the last step, and of what came since
    };
    double time(const Seat& seat) const { return seat.cost * seat.load; }
    double mean_time() const;

    Schedule schedule_;
    std::vector<Seat> seats_;
    std::optional<std::size_t> chosen_;
    double load_of_pair_ = 1; ///< mean of the last step
    double cost_of_move_ = 0; ///< milliseconds a unit of load
    unsigned uneven_steps_ = 0;
    bool moved_ = false; ///< in this step
};

} // namespace raycontact
