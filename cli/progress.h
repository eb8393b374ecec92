// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

/// A bar on standard error with the time left, on a terminal only.
class Progress {
public:
    enum class Elsewhere { silent, lines }; ///< lines: one at the start, then one a tenth, as for a log
    /// `unit`: what is counted, as "step"; without one only the percentage is shown.
    Progress(std::string title, std::uint32_t total, std::string unit = "step",
             Elsewhere elsewhere = Elsewhere::silent);
    void show(std::uint32_t now);
    void done();

private:
    std::string title_, unit_;
    std::uint32_t total_;
    std::uint32_t shown_ = 0; ///< percent
    bool terminal_, lines_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};
