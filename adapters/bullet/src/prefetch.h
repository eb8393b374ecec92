// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace raycontact::bullet {

/// Asks the processor for what lies there, which will soon be read. It need not exist.
inline void prefetch([[maybe_unused]] const void* place) {
#if defined(__GNUC__) || defined(__clang__)
    __builtin_prefetch(place);
#endif
}

} // namespace raycontact::bullet
