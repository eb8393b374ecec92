// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

namespace raycontact {

/// A number at `at` in the byte order of the file; the caller has checked that sizeof(T) bytes are there.
template <class T>
T read_bytes(const char* at, bool little_endian = true) {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), at, sizeof(T));
    if (little_endian != (std::endian::native == std::endian::little)) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
}

} // namespace raycontact
