// SPDX-License-Identifier: Apache-2.0
#include "device/ptx.h"

#include <algorithm>
#include <span>
#include <sstream>
#include <string_view>

namespace raycontact::device_test {

namespace {

constexpr std::string_view rounding[] = {"add.rn.f32", "sub.rn.f32",  "mul.rn.f32",     "div.rn.f32",
                                         "rcp.rn.f32", "sqrt.rn.f32", "cvt.rn.f32.u32", "cvt.rn.f32.s32"};
// What finds pairs and places them.
constexpr std::string_view rounding_double[] = {"add.rn.f64", "sub.rn.f64", "mul.rn.f64", "cvt.rn.f32.f64"};
// Move, compare, choose, cut off: no rounding. min and max ignore a NaN, as `a < b ? a : b` does with a constant b.
constexpr std::string_view exact[] = {"neg.f32", "abs.f32",  "min.f32",         "max.f32",         "mov.f32",
                                      "mov.f64", "selp.f32", "cvt.rzi.s32.f32", "cvt.rzi.u32.f32", "neg.f64",
                                      "abs.f64", "min.f64",  "max.f64",         "selp.f64",        "cvt.f64.f32"};
constexpr std::string_view exact_families[] = {"setp.", "set.", "ld.", "st."};

bool contains(std::span<const std::string_view> list, std::string_view word) {
    return std::find(list.begin(), list.end(), word) != list.end();
}

// "@%p1 add.rn.f32 %f1, ..." gives "add.rn.f32"; directives and labels give nothing.
std::string opcode_of(const std::string& line) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word.starts_with("@")) words >> word;
    if (word.empty() || word.find_first_of(".:{}(/$") == 0 || word.find('.') == std::string::npos) return "";
    return word.substr(0, word.find(';'));
}

} // namespace

PtxReport read_ptx(const std::string& ptx) {
    PtxReport report;
    std::istringstream lines(ptx);
    for (std::string line; std::getline(lines, line);) {
        const std::string entry = ".entry ";
        if (const auto at = line.find(entry); at != std::string::npos) {
            const std::string name = line.substr(at + entry.size());
            report.entries.push_back(name.substr(0, name.find('(')));
            continue;
        }
        const std::string opcode = opcode_of(line);
        if (opcode.find(".f") == std::string::npos && opcode.find(".bf") == std::string::npos) continue;
        const bool of_double = opcode.find(".f64") != std::string::npos;
        const bool flushes =
            opcode.find(".ftz") != std::string::npos || (opcode.find(".f32") == std::string::npos && !of_double);
        const bool chooses = std::any_of(std::begin(exact_families), std::end(exact_families),
                                         [&](std::string_view family) { return opcode.starts_with(family); });
        if (opcode == "fma.rn.f32")
            ++report.fused;
        else if (contains(rounding, opcode))
            ++report.rounded;
        else if (contains(rounding_double, opcode))
            ++report.rounded_double;
        else if (flushes || !(chooses || contains(exact, opcode)))
            report.inexact.push_back(line);
    }
    return report;
}

} // namespace raycontact::device_test
