// SPDX-License-Identifier: Apache-2.0
#include "schedule/balance.h"

#include <algorithm>

namespace raycontact {

namespace {

constexpr double uneven = 1.1;        // of the mean time
constexpr unsigned steps_to_wait = 8; // before pairs move
constexpr double steps_to_gain = 32;  // in which a move must pay for itself
constexpr double smoothing = 1.0 / 8; // weight of the last step in what is measured

} // namespace

// Rough: what each costs beside a pair at rest. What a unit costs is measured on each device.
double load_of(const StepStats& stats) {
    return static_cast<double>(stats.pairs) + 0.05 * static_cast<double>(stats.details.vertices)
           + 2 * static_cast<double>(stats.details.rays_cast + stats.details.walks);
}

Balance::Balance(Schedule schedule, std::span<const double> costs) : schedule_(schedule) {
    for (const double cost : costs) seats_.push_back({.cost = cost});
}

std::size_t Balance::part_for_new_pair() {
    const auto later = [&](const Seat& seat) { return seat.cost * (seat.load + load_of_pair_); };
    Seat* best = chosen_ ? &seats_[*chosen_] : nullptr;
    for (Seat& seat : seats_)
        if (!chosen_ && seat.there && (!best || later(seat) < later(*best))) best = &seat;
    best->load += load_of_pair_;
    return static_cast<std::size_t>(best - seats_.data());
}

void Balance::record(std::size_t part, double load, double ms) {
    Seat& seat = seats_[part];
    seat.load = load;
    if (schedule_ == Schedule::counted || load < 1) return;
    seat.measured += (seat.measured > 0 ? smoothing : 1) * (ms / load - seat.measured);
}

void Balance::end_step(std::size_t pair_count) {
    double load = 0, slowest = 0;
    bool all_measured = true;
    for (const Seat& seat : seats_) all_measured = all_measured && (!seat.there || seat.measured > 0);
    for (Seat& seat : seats_) {
        if (!seat.there) continue;
        if (all_measured) seat.cost = seat.measured;
        load += seat.load;
        slowest = std::max(slowest, time(seat));
    }
    if (pair_count > 0) load_of_pair_ = std::max(1.0, load / static_cast<double>(pair_count));
    uneven_steps_ = slowest > uneven * mean_time() && !moved_ ? uneven_steps_ + 1 : 0;
    moved_ = false;
}

double Balance::mean_time() const {
    double sum = 0, count = 0;
    for (const Seat& seat : seats_)
        if (seat.there) sum += time(seat), ++count;
    return sum / count;
}

void Balance::drop(std::size_t part) {
    seats_[part] = {.there = false};
    if (chosen_ == part) chosen_.reset();
    uneven_steps_ = 0;
}

std::optional<Balance::Move> Balance::next_move() const {
    if (chosen_ || schedule_ == Schedule::sticky || uneven_steps_ < steps_to_wait) return std::nullopt;
    const Seat *from = nullptr, *to = nullptr;
    for (const Seat& seat : seats_) {
        if (!seat.there) continue;
        if (!from || time(seat) > time(*from)) from = &seat;
        if (!to || time(seat) < time(*to)) to = &seat;
    }
    const double mean = mean_time();
    const double load = std::min((time(*from) - mean) / from->cost, (mean - time(*to)) / to->cost);
    if (time(*from) <= uneven * mean || load <= 0 || from->cost * steps_to_gain < cost_of_move_) return std::nullopt;
    return Move{static_cast<std::size_t>(from - seats_.data()), static_cast<std::size_t>(to - seats_.data()),
                load / from->load};
}

void Balance::record_move(const Move& move, double ms) {
    moved_ = true;
    const double load = move.share * seats_[move.from].load;
    seats_[move.from].load -= load;
    seats_[move.to].load += load;
    if (schedule_ == Schedule::balanced && load > 0)
        cost_of_move_ += (cost_of_move_ > 0 ? smoothing : 1) * (ms / load - cost_of_move_);
}

} // namespace raycontact
