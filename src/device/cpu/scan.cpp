// SPDX-License-Identifier: Apache-2.0
#include "device/cpu/scan.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace raycontact::cpu {

namespace {

constexpr kernels::uint block = 16384; // fewer items are not worth a second thread

std::uint64_t sum_of(const kernels::uint* values, kernels::uint count) {
    std::uint64_t sum = 0;
    for (kernels::uint i = 0; i < count; ++i) sum += values[i];
    return sum;
}

// Past 2^32 the firsts are worth nothing, but then there is no room either.
void write_firsts(const kernels::uint* values, kernels::uint count, std::uint64_t sum, kernels::uint* firsts) {
    auto at = static_cast<kernels::uint>(sum);
    for (kernels::uint i = 0; i < count; ++i) {
        firsts[i] = at;
        at += values[i];
    }
}

} // namespace

void Scanner::run(Executor& executor, const HostScan& scan) {
    const kernels::uint blocks = scan.count == 0 ? 0 : (scan.count - 1) / block + 1;
    const auto size_of = [&](kernels::uint b) { return std::min(block, scan.count - b * block); };
    sums_.resize(std::size_t{blocks} * scan.columns);
    executor.run(blocks, 1, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t b = begin; b < end; ++b)
            for (kernels::uint c = 0; c < scan.columns; ++c)
                sums_[c * blocks + b] =
                    sum_of(scan.values + std::size_t{c} * scan.stride + std::size_t{b} * block, size_of(b));
    });
    std::array<std::uint64_t, MOST_COLUMNS> totals{};
    for (kernels::uint c = 0; c < scan.columns; ++c)
        for (kernels::uint b = 0; b < blocks; ++b) {
            std::uint64_t& own = sums_[c * blocks + b];
            const std::uint64_t before = totals[c];
            totals[c] += own;
            own = before;
        }
    executor.run(blocks, 1, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t b = begin; b < end; ++b)
            write_firsts(scan.values + std::size_t{b} * block, size_of(b), sums_[b],
                         scan.firsts + std::size_t{b} * block);
    });
    const bool fits = totals[0] <= scan.room;
    scan.totals->items = fits && totals[0] > 0 ? scan.count : 0;
    scan.totals->results = fits ? static_cast<kernels::uint>(totals[0]) : 0;
    for (std::size_t c = 0; c < MOST_COLUMNS; ++c)
        scan.totals->sums[c] = static_cast<kernels::uint>(std::min<std::uint64_t>(totals[c], NONE));
}

} // namespace raycontact::cpu
