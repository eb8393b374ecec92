// SPDX-License-Identifier: Apache-2.0
#include <view/blob.h>

#include <zlib.h>

#include <stdexcept>

namespace raycontact::view {

void put16(Bytes& to, std::uint32_t value) {
    to.push_back(static_cast<unsigned char>(value));
    to.push_back(static_cast<unsigned char>(value >> 8));
}

void put32(Bytes& to, std::uint32_t value) {
    put16(to, value);
    put16(to, value >> 16);
}

Bytes split_bytes(std::span<const std::uint16_t> numbers) {
    Bytes bytes;
    bytes.reserve(2 * numbers.size());
    for (const std::uint16_t n : numbers) bytes.push_back(static_cast<unsigned char>(n));
    for (const std::uint16_t n : numbers) bytes.push_back(static_cast<unsigned char>(n >> 8));
    return bytes;
}

std::string blob(std::span<const unsigned char> bytes) {
    uLongf length = compressBound(static_cast<uLong>(bytes.size()));
    Bytes packed(length);
    const int status = compress2(packed.data(), &length, bytes.data(), static_cast<uLong>(bytes.size()), 9);
    if (status != Z_OK) throw std::runtime_error("view: zlib failed (" + std::to_string(status) + ")");
    packed.resize(length);

    static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((packed.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < packed.size(); i += 3) {
        std::uint32_t word = 0;
        const std::size_t count = packed.size() - i < 3 ? packed.size() - i : 3;
        for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? packed[i + k] : 0U);
        for (std::size_t k = 0; k < 4; ++k) text += k <= count ? digits[word >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

} // namespace raycontact::view
