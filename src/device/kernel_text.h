// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>

namespace raycontact {

/// A stretch of the kernels' text, and the file it is from.
struct KernelPiece {
    std::string_view file, text;
};

/// Dialect, types and kernels in one text. with_double: false leaves out the kernels that compute in double.
inline std::string kernel_text(std::span<const KernelPiece> pieces, bool with_double) {
    constexpr std::string_view in_double[] = {"kernels/body_place.h", "kernels/body_box.h", "kernels/place_pairs.h",
                                              "kernels/find_pairs.h", "device/gpu/probe_double.h"};
    std::string text;
    for (const KernelPiece& piece : pieces)
        if (with_double || std::find(std::begin(in_double), std::end(in_double), piece.file) == std::end(in_double))
            text += piece.text;
    return text;
}

} // namespace raycontact
