// SPDX-License-Identifier: Apache-2.0
#include <report/image.h>

#include <stdexcept>

// Private to this file: another library may carry its own stb.
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

namespace raycontact::report {
namespace {

void append(void* text, void* data, int size) {
    static_cast<std::string*>(text)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

} // namespace

std::string encode_png(const Image& image) {
    std::string bytes;
    const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
    if (!stbi_write_png_to_func(append, &bytes, width, height, 3, image.rgb.data(), 3 * width))
        throw std::runtime_error("a picture could not be written as PNG");
    return bytes;
}

std::string encode_jpeg(const Image& image, int quality) {
    std::string bytes;
    const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
    if (!stbi_write_jpg_to_func(append, &bytes, width, height, 3, image.rgb.data(), quality))
        throw std::runtime_error("a picture could not be written as JPEG");
    return bytes;
}

std::string base64(std::string_view bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t k = 0; k < bytes.size(); k += 3) {
        std::uint32_t word = 0;
        for (std::size_t i = 0; i < 3; ++i)
            word = word << 8 | (k + i < bytes.size() ? static_cast<std::uint8_t>(bytes[k + i]) : 0u);
        for (std::size_t i = 0; i < 4; ++i) text += k + i <= bytes.size() ? digits[word >> (18 - 6 * i) & 63u] : '=';
    }
    return text;
}

} // namespace raycontact::report
