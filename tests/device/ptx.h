// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace raycontact::device_test {

/// What a PTX text says of its arithmetic.
struct PtxReport {
    std::vector<std::string> entries;
    std::vector<std::string> inexact; ///< instructions on floats that are not known to round as ours do
    std::size_t fused = 0;            ///< fma.rn.f32
    std::size_t rounded = 0;          ///< add, sub, mul, div, rcp, sqrt with .rn
    std::size_t rounded_double = 0;   ///< add, sub, mul and rounding to float, of double
};
PtxReport read_ptx(const std::string& ptx);

} // namespace raycontact::device_test
