// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace raycontact::report {

/// Where, when and from what a figure was measured: no figure is worth anything without.
struct Machine {
    std::string date;   ///< UTC, 2026-01-31
    std::string commit; ///< of the build, "+changes" where the tree was not clean, "unknown" without git
    std::string cpu;    ///< model name
    std::uint32_t cores = 0;
    std::string compiler;   ///< of the program
    std::string governor;   ///< of the first core; "unknown" where the kernel does not say
    double load = 0;        ///< average of the last minute, this program included
    std::string slug;       ///< "amd-epyc-2": names the folder of the results
    bool cut_short = false; ///< a signal ended the benchmark: some of its rows are missing
};

/// As it is now.
Machine this_machine();

/// One line for a person.
std::string heading(const Machine& machine, bool with_load = true);

} // namespace raycontact::report
