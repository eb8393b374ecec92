// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <fmt/format.h>

#include <iostream>
#include <utility>

#include <unistd.h>

namespace {
constexpr std::uint32_t cells = 40;
}

Progress::Progress(std::string title, std::uint32_t total)
    : title_(std::move(title)), total_(total), terminal_(isatty(STDERR_FILENO) != 0) {}

void Progress::show(std::uint32_t now) {
    if (!terminal_ || total_ == 0) return;
    const auto percent = static_cast<std::uint32_t>(std::uint64_t{100} * now / total_);
    if (percent == shown_ && now != 1) return;
    shown_ = percent;
    const std::uint32_t full = cells * percent / 100;
    std::cerr << fmt::format("\r{} [{:=<{}}{: <{}}] {:3}% step {} of {}", title_, "", full, "", cells - full, percent,
                             now, total_)
              << std::flush;
}

void Progress::done() {
    if (terminal_) std::cerr << '\n';
}
