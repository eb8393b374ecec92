// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace raycontact {

/// Frees what these hold, which "list = {}" does not do for a vector.
template <class... T>
void free_all(T&... held) {
    ((held = T()), ...);
}

/// Whether so many of `slots` are in use that those who number by them should begin anew.
inline bool is_mostly_empty(std::size_t slots, std::size_t used) {
    return slots > 4 * used + 1024;
}

} // namespace raycontact
