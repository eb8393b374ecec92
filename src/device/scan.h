// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/launch.h"

namespace raycontact {

/// Exclusive prefix sum on a device; keeps its scratch memory between calls.
class Scan {
public:
    /// firsts[i] = values[0] + ... + values[i - 1]; returns the total. Throws std::length_error where 32 bits cannot
    /// hold it.
    kernels::uint run(Device& device, const Array<kernels::uint>& values, Array<kernels::uint>& firsts);

    /// Their sum alone.
    kernels::uint total(Device& device, const Array<kernels::uint>& values);

private:
    kernels::uint sum_up(Device& device, const Array<kernels::uint>& values);
    kernels::uint read_total(Device& device, kernels::uint blocks) const;

    Array<kernels::uint> sums_;
};

} // namespace raycontact
