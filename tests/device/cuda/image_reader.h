// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace raycontact::cuda_test {

/// Whether the parameters of a kernel are pointers, as its text in an image of the test compiler declares them; empty
/// if there is no such kernel.
inline std::vector<bool> parameters_of(const std::string& image, const std::string& kernel) {
    std::vector<bool> pointers;
    const std::string begin = "KERNEL void " + kernel + "(";
    std::size_t at = image.find(begin);
    if (at == std::string::npos) return pointers;
    std::string parameter;
    int depth = 1;
    for (at += begin.size(); at < image.size() && depth > 0; ++at) {
        const char letter = image[at];
        depth += letter == '(' ? 1 : letter == ')' ? -1 : 0;
        if (depth > 0 && !(depth == 1 && letter == ',')) {
            parameter += letter;
            continue;
        }
        if (parameter.find("COUNT(") != std::string::npos) {
            pointers.insert(pointers.end(), {true, false});
        } else {
            const auto has = [&](std::string_view word) { return parameter.find(word) != std::string::npos; };
            pointers.push_back(has("*") || has("READS(") || has("WRITES("));
        }
        parameter.clear();
    }
    return pointers;
}

/// Why a driver of a CUDA version, with a device of an architecture, would not load the image; empty if it would.
inline std::string refuses(const std::string& image, int version, int architecture) {
    const auto number_after = [&](const std::string& mark) {
        return std::stoi(image.substr(image.find(mark) + mark.size()));
    };
    if (image.starts_with("cubin ")) {
        const std::string own = "cubin " + std::to_string(architecture) + " ";
        if (!image.starts_with(own)) return "a cubin of another architecture";
        return number_after(own) > version / 1000 ? "a cubin of a newer CUDA" : "";
    }
    if (!image.starts_with("// PTX\n")) return "no image";
    if (number_after("\n.target sm_") > architecture) return "PTX of a newer architecture";
    // A driver of CUDA 12.8 reads PTX up to 8.8, about: what its own compiler writes.
    const int major = number_after("\n.version ");
    const int minor = number_after("\n.version " + std::to_string(major) + ".");
    const int own = version / 1000 - 4;
    return major > own || (major == own && minor > version % 1000 / 10) ? "PTX of a newer CUDA" : "";
}

} // namespace raycontact::cuda_test
