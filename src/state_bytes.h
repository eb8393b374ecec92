// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace raycontact {

// What a scene, or a part, keeps, one value after the other, as the machine has it.

/// Some values in a row.
template <class T>
void put_row(std::vector<std::byte>& bytes, const T* first, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::size_t at = bytes.size();
    bytes.resize(at + count * sizeof(T));
    if (count > 0) std::memcpy(bytes.data() + at, first, count * sizeof(T));
}

template <class T>
void put_bytes(std::vector<std::byte>& bytes, const T& value) {
    put_row(bytes, &value, 1);
}

template <class T>
T take_bytes(std::span<const std::byte>& bytes) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (bytes.size() < sizeof(T)) throw std::logic_error("a state that was saved is cut off");
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    bytes = bytes.subspan(sizeof value);
    return value;
}

/// A list, after its length.
template <class T>
void put_list(std::vector<std::byte>& bytes, std::span<const T> list) {
    put_bytes(bytes, std::uint64_t{list.size()});
    put_row(bytes, list.data(), list.size());
}

template <class T>
std::vector<T> take_list(std::span<const std::byte>& bytes) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto size = take_bytes<std::uint64_t>(bytes);
    if (bytes.size() / sizeof(T) < size) throw std::logic_error("a state that was saved is cut off");
    std::vector<T> list(size);
    if (size > 0) std::memcpy(list.data(), bytes.data(), size * sizeof(T));
    bytes = bytes.subspan(size * sizeof(T));
    return list;
}

} // namespace raycontact
