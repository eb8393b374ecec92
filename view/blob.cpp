// SPDX-License-Identifier: Apache-2.0
#include <view/blob.h>

#include <report/image.h>

#include <zlib.h>

#include <stdexcept>

namespace raycontact::view {

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
    return report::base64({reinterpret_cast<const char*>(packed.data()), length});
}

} // namespace raycontact::view
