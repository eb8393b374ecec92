// SPDX-License-Identifier: Apache-2.0
#include "schedule/choice.h"

#include "number_text.h"

#include <algorithm>
#include <cmath>

namespace raycontact {

namespace {

// Milliseconds. Opening a GPU takes about as long once its kernels are compiled: a scene that ends before would
// never get it back.
constexpr double opening = 200;
// Milliseconds. On a GPU a step is a dozen launches and a read that waits, some 10 us each, however few its pairs are.
constexpr double least = 0.1;
constexpr double clearly = 0.9;  // of the time of the other: what is faster by less is not worth a move
constexpr double changed = 2;    // times as many pairs, or as long a step
constexpr double least_gap = 50; // times what a trial has cost

bool differ(double a, double b) {
    return std::max(a, b) > changed * std::min(a, b);
}

// "1.2", "0.0431": three digits are more than the clock repeats.
std::string milliseconds(double ms) {
    const double unit = std::pow(10, std::floor(std::log10(std::max(ms, 1e-3))) - 2);
    return text_of(std::round(ms / unit) * unit) + " ms";
}

} // namespace

DeviceChoice::DeviceChoice() : wait_(opening) {}

void DeviceChoice::record(std::uint64_t pairs, double ms) {
    since_trial_ += ms;
    if (trying_) {
        trial_ += ms;
        ++trial_steps_;
    }
    if (uncounted_ > 0) {
        --uncounted_;
        return;
    }
    times_[time_count_++] = ms;
    if (time_count_ < window) return;
    time_count_ = 0;
    std::ranges::sort(times_);
    const double median = times_[window / 2];
    if (trying_) return end_trial(median);
    ms_ = median;
    pairs_ = pairs;
    if (!there_[1 - best_] || is_too_short() || since_trial_ < wait_ || !has_changed()) return;
    trying_ = true;
    uncounted_ = warm_up;
    trial_ = 0;
    trial_steps_ = 0;
}

bool DeviceChoice::is_too_short() const {
    return best_ == 0 && ms_ < least;
}

bool DeviceChoice::has_changed() const {
    if (compared_.pairs == 0) return true;
    return differ(static_cast<double>(pairs_), static_cast<double>(compared_.pairs))
           || differ(ms_, compared_.ms[best_]);
}

void DeviceChoice::end_trial(double ms) {
    compared_.ms[best_] = ms_;
    compared_.ms[1 - best_] = ms;
    compared_.pairs = std::max<std::uint64_t>(pairs_, 1);
    pay();
    if (ms < clearly * ms_) {
        best_ = 1 - best_;
        ms_ = ms;
    } else {
        uncounted_ = warm_up;
    }
}

// The next trial waits for what this one has cost, whatever ended it.
void DeviceChoice::pay() {
    wait_ = std::max(opening, least_gap * (trial_ - trial_steps_ * ms_));
    since_trial_ = 0;
    trying_ = false;
}

void DeviceChoice::record_move(double ms) {
    if (trying_) trial_ += 2 * ms; // and back
}

void DeviceChoice::exclude(std::size_t part, const std::string& why) {
    there_[part] = false;
    why_not_ = why;
    if (part == best_) best_ = 1 - best_;
    forget();
}

void DeviceChoice::forget() {
    if (trying_) pay();
    uncounted_ = warm_up;
    time_count_ = 0;
    ms_ = 0;
    compared_ = {};
}

std::string DeviceChoice::text(const std::array<std::string, 2>& names) const {
    const std::string& best = names[best_];
    const std::string& other = names[1 - best_];
    if (!there_[1 - best_]) return best + ": " + why_not_;
    if (trying_)
        return other + ": being tried, " + best + " takes " + milliseconds(ms_) + " a step with "
               + counted(pairs_, "pair");
    if (compared_.pairs > 0)
        return best + ": " + milliseconds(compared_.ms[best_]) + " a step, " + other + " "
               + milliseconds(compared_.ms[1 - best_]) + ", measured with " + counted(compared_.pairs, "pair");
    if (ms_ == 0) return best + ": not measured yet";
    return best + ": " + milliseconds(ms_) + " a step with " + counted(pairs_, "pair") + ", "
           + (is_too_short() ? "too short for " + other + " to gain" : "too few steps so far to try " + other);
}

} // namespace raycontact
