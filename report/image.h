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

/// An animated WebP that begins anew at its end; frames of one size. Throws std::runtime_error if libwebp fails.
std::string encode_webp(const std::vector<Image>& frames, int milliseconds_a_frame);

} // namespace raycontact::report
