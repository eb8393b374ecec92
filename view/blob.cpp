// SPDX-License-Identifier: Apache-2.0
#include <view/blob.h>

#include <zlib.h>

#include <stdexcept>
#include <string_view>

namespace raycontact::view {

Bytes split_bytes(std::span<const std::uint16_t> numbers) {
    Bytes bytes;
    bytes.reserve(2 * numbers.size());
    for (const std::uint16_t n : numbers) bytes.push_back(static_cast<unsigned char>(n));
    for (const std::uint16_t n : numbers) bytes.push_back(static_cast<unsigned char>(n >> 8));
    return bytes;
}

std::string base64(std::span<const unsigned char> bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t k = 0; k < bytes.size(); k += 3) {
        std::uint32_t word = 0;
        for (std::size_t i = 0; i < 3; ++i) word = word << 8 | (k + i < bytes.size() ? bytes[k + i] : 0u);
        for (std::size_t i = 0; i < 4; ++i) text += k + i <= bytes.size() ? digits[word >> (18 - 6 * i) & 63u] : '=';
    }
    return text;
}

std::string blob(std::span<const unsigned char> bytes) {
    uLongf length = compressBound(static_cast<uLong>(bytes.size()));
    Bytes packed(length);
    const int status = compress2(packed.data(), &length, bytes.data(), static_cast<uLong>(bytes.size()), 9);
    if (status != Z_OK) throw std::runtime_error("view: zlib failed (" + std::to_string(status) + ")");
    return base64(std::span(packed).first(length));
}

} // namespace raycontact::view
