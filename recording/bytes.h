// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace raycontact::recording {

using Bytes = std::vector<unsigned char>;

/// What is wrong with bytes that were read; whoever read them adds the file and the place.
class Damage : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// Little-endian on every machine.

template <std::unsigned_integral T>
void put(Bytes& to, T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) to.push_back(static_cast<unsigned char>(value >> (8 * i)));
}

inline void put(Bytes& to, double value) {
    put(to, std::bit_cast<std::uint64_t>(value));
}

inline void put(Bytes& to, float value) {
    put(to, std::bit_cast<std::uint32_t>(value));
}

inline void put(Bytes& to, std::string_view text) {
    put(to, static_cast<std::uint32_t>(text.size()));
    for (const char c : text) to.push_back(static_cast<unsigned char>(c));
}

/// Seven bits a byte, the lowest first.
inline void put_varint(Bytes& to, std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) to.push_back(static_cast<unsigned char>(value | 0x80));
    to.push_back(static_cast<unsigned char>(value));
}

/// Reads what put() wrote; throws Damage where the bytes end too early.
class ByteSource {
public:
    explicit ByteSource(std::span<const unsigned char> bytes) : bytes_(bytes) {}

    std::size_t left() const { return bytes_.size() - at_; }

    std::span<const unsigned char> take(std::size_t count) {
        if (count > left()) throw Damage("ends too early");
        at_ += count;
        return bytes_.subspan(at_ - count, count);
    }

    template <std::unsigned_integral T>
    T get() {
        const auto from = take(sizeof(T));
        T value = 0;
        for (std::size_t i = 0; i < sizeof(T); ++i) value = static_cast<T>(value | static_cast<T>(from[i]) << (8 * i));
        return value;
    }

    double get_double() { return std::bit_cast<double>(get<std::uint64_t>()); }

    std::uint64_t get_varint() {
        std::uint64_t value = 0;
        for (unsigned shift = 0; shift < 64; shift += 7) {
            const unsigned char byte = take(1)[0];
            value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
            if (byte < 0x80) return value;
        }
        throw Damage("holds a number of more than 64 bits");
    }

    /// A count of records of at least `least` bytes each; one that cannot fit is refused before it is allocated.
    std::size_t get_count(std::size_t least) {
        const std::uint64_t count = get<std::uint32_t>();
        if (count * least > left()) throw Damage("counts more than it holds");
        return static_cast<std::size_t>(count);
    }

    std::string get_text() {
        const auto text = take(get_count(1));
        return {text.begin(), text.end()};
    }

private:
    std::span<const unsigned char> bytes_;
    std::size_t at_ = 0;
};

} // namespace raycontact::recording
