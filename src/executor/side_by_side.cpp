// SPDX-License-Identifier: Apache-2.0
#include "executor/side_by_side.h"

#include "executor/float_environment.h"
#include "interruption.h"
#include "platform/system.h"

#include <chrono>

namespace raycontact {

namespace {

using Clock = std::chrono::steady_clock;

// A thread that sleeps takes some 50 us to wake, so it stays awake for a while when it expects something at once.
constexpr Clock::duration awake_before_a_run = std::chrono::microseconds(500);
constexpr Clock::duration awake_at_the_end = std::chrono::microseconds(50);

template <class Done>
bool wait_awake(Clock::duration most, Done&& done) {
    for (const auto start = Clock::now(); !done(); std::this_thread::yield())
        if (Clock::now() - start > most) return false;
    return true;
}

} // namespace

SideBySide::SideBySide(std::size_t count)
    : process_(platform::process_id()), threads_(std::make_unique<std::vector<std::jthread>>()) {
    try {
        for (std::size_t i = 1; i < count; ++i) threads_->emplace_back([this, i] { serve(i); });
    } catch (...) {
        end(); // or those there are would be waited for for ever
        throw;
    }
}

SideBySide::~SideBySide() {
    if (has_threads())
        end();
    else
        static_cast<void>(threads_.release()); // they cannot be joined
}

bool SideBySide::has_threads() const {
    return process_ == platform::process_id();
}

void SideBySide::end() {
    function_ = nullptr;
    ++runs_;
    wake();
}

void SideBySide::wake() {
    ++calls_;
    calls_.notify_all();
}

void SideBySide::run(const std::function<void(std::size_t)>& function) {
    if (!has_threads()) {
        for (std::size_t i = 0; i <= threads_->size(); ++i) function(i);
        return;
    }
    function_ = &function;
    flag_ = interruption_flag;
    running_ = static_cast<std::uint32_t>(threads_->size());
    ++runs_;
    wake();
    function(0);
    if (wait_awake(awake_at_the_end, [&] { return running_ == 0; })) return;
    while (const std::uint32_t left = running_) running_.wait(left);
}

void SideBySide::serve(std::size_t number) {
    const FloatEnvironment environment;
    std::uint32_t calls = 0;
    for (std::uint32_t run = 1;; ++run) {
        do {
            calls_.wait(calls);
            calls = calls_;
        } while (!wait_awake(awake_before_a_run, [&] { return runs_ == run; }));
        if (!function_) return;
        {
            const Interruptible interruptible(flag_);
            (*function_)(number);
        }
        calls = calls_; // the next call is for the next run
        if (--running_ == 0) running_.notify_one();
    }
}

} // namespace raycontact
