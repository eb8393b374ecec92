// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace raycontact {

/// Frees what these hold, which "list = {}" does not do for a vector.
template <class... T>
void free_all(T&... held) {
    ((held = T()), ...);
}

} // namespace raycontact
