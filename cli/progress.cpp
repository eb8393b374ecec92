// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <utility>

#include <unistd.h>

namespace {

constexpr std::uint32_t cells = 40;

/// Of work of which `done` of `total` took so many seconds, 0 < done <= total: "1 min 5 s left".
std::string time_left(double seconds, double done, double total) {
    const auto left = static_cast<std::uint64_t>(std::ceil(seconds * (total - done) / done));
    return left < 60 ? fmt::format("{} s left", left) : fmt::format("{} min {} s left", left / 60, left % 60);
}

} // namespace

Progress::Progress(std::string title, std::uint32_t total, std::string unit, Elsewhere elsewhere)
    : title_(std::move(title)), unit_(std::move(unit)), total_(total), terminal_(isatty(STDERR_FILENO) != 0),
      lines_(!terminal_ && elsewhere == Elsewhere::lines) {
    if (lines_ && total_ > 0) std::cerr << title_ << ": begins" << std::endl;
}

void Progress::show(std::uint32_t now) {
    if (!(terminal_ || lines_) || total_ == 0 || now == 0) return;
    const auto percent = static_cast<std::uint32_t>(std::uint64_t{100} * now / total_);
    if (lines_ ? percent / 10 == shown_ / 10 : percent == shown_ && now != 1) return;
    shown_ = percent;
    const std::uint32_t full = cells * percent / 100;
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start_;
    const std::string counted = unit_.empty() ? "" : fmt::format(" {} {} of {},", unit_, now, total_);
    const std::string left = time_left(took.count(), now, total_);
    if (lines_)
        std::cerr << fmt::format("{}: {}%,{} {}\n", title_, percent, counted, left);
    else // the end of a longer line before this one is wiped out
        std::cerr << fmt::format("\r{} [{:=<{}}{: <{}}] {:3}%{} {}\x1b[K", title_, "", full, "", cells - full, percent,
                                 counted, left);
    std::cerr << std::flush;
}

void Progress::done() {
    if (terminal_ && total_ > 0) std::cerr << '\n';
}
