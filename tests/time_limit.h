// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>

/// Whether times are held against limits. They depend on what else a machine does, so only `scripts/test long` does
/// it, by RAYCONTACT_TIMES; the quick tier asserts what can be counted.
inline bool times_are_tested() {
    return std::getenv("RAYCONTACT_TIMES") != nullptr;
}

/// Where times are tested, fails if it lives longer.
class TimeLimit {
public:
    explicit TimeLimit(int seconds) : limit_(seconds) {}
    ~TimeLimit() {
        if (times_are_tested()) {
            EXPECT_LT(std::chrono::steady_clock::now() - start_, limit_);
        }
    }
    TimeLimit(const TimeLimit&) = delete;
    TimeLimit& operator=(const TimeLimit&) = delete;

private:
    std::chrono::seconds limit_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};
