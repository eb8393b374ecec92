// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"
#include "executor/executor.h"

#include <vector>

namespace raycontact::cpu {

/// ScanOf with host pointers.
struct HostScan {
    kernels::uint count = 0, columns = 0, stride = 0;
    const kernels::uint* values = nullptr;
    kernels::uint* firsts = nullptr;
    kernels::Totals* totals = nullptr;
    kernels::uint room = 0;
};

/// Scans on the executor's threads. The sums are of integers, so that no split among threads changes a bit.
class Scanner {
public:
    void run(Executor& executor, const HostScan& scan);

private:
    std::vector<std::uint64_t> sums_; ///< of blocks, column by column
};

} // namespace raycontact::cpu
