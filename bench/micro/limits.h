// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace raycontact::bench {

// What this processor can do at best, to set the kernels' figures beside. x86-64 only.

/// Runs `rounds` rounds of 16 dependent multiplications of integers, three cycles each on every processor since 2008
/// or so; returns the cycles that takes.
std::uint64_t spend_cycles(std::uint64_t rounds);

/// Runs `rounds` rounds of independent float32 vector multiplications and additions, as many of one as of the other, as
/// wide as the instruction set ("baseline", "avx2", "avx512"); returns how many floats were multiplied or added.
std::uint64_t spend_operations(std::string_view instruction_set, std::uint64_t rounds);

} // namespace raycontact::bench
