// SPDX-License-Identifier: Apache-2.0
#pragma once

#if !defined(__GNUC__) && !defined(__clang__) && defined(_M_X64)
#include <xmmintrin.h>
#endif

namespace raycontact::platform {

/// Asks the processor for what lies there, which will soon be read. It need not exist.
inline void prefetch(const void* place) {
#if defined(__GNUC__) || defined(__clang__)
    __builtin_prefetch(place);
#elif defined(_M_X64)
    _mm_prefetch(static_cast<const char*>(place), _MM_HINT_T0);
#else
    (void)place;
#endif
}

} // namespace raycontact::platform
