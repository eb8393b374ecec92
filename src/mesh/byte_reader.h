// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace raycontact {

/// A number at `at` in the byte order of the file; the caller has checked that sizeof(T) bytes are there.
template <class T>
T read_bytes(const char* at, bool little_endian = true) {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), at, sizeof(T));
    if (little_endian != (std::endian::native == std::endian::little)) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
}

/// How a binary file stores a kind of number. A double holds every value of all kinds.
struct NumberType {
    std::size_t size;
    bool whole;
    double (*read)(const char* at, bool little_endian);
};

template <class T>
constexpr NumberType number_type{sizeof(T), std::is_integral_v<T>, [](const char* at, bool little_endian) {
                                     return static_cast<double>(read_bytes<T>(at, little_endian));
                                 }};

} // namespace raycontact
