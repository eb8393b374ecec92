// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace raycontact::report {

/// 8-bit sRGB, row by row from the top left.
struct Image {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
};

std::string encode_png(const Image& image);
std::string encode_jpeg(const Image& image, int quality);
std::string base64(std::string_view bytes);

} // namespace raycontact::report
