// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace raycontact {

/// Frees the room of a list that has much more of it than it uses, a megabyte or more. Keeps the elements.
template <class T>
void give_back(std::vector<T>& list) {
    constexpr std::size_t kept_anyway = 1 << 20; // bytes
    if (list.capacity() * sizeof(T) > kept_anyway && list.capacity() > 4 * list.size()) list.shrink_to_fit();
}
/// Of anything else that can.
template <class T>
requires requires(T& kept) {
    kept.give_back();
}
void give_back(T& kept) {
    kept.give_back();
}
template <class First, class Second, class... More>
void give_back(First& first, Second& second, More&... more) {
    give_back(first);
    give_back(second, more...);
}

/// Frees a list's memory, which "list = {}" does not.
template <class T>
void free_all(std::vector<T>& list) {
    std::vector<T>().swap(list);
}

/// Whether so many of `slots` are in use that those who number by them should begin anew.
inline bool is_mostly_empty(std::size_t slots, std::size_t used) {
    return slots > 4 * used + 1024;
}

} // namespace raycontact
