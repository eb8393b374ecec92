// SPDX-License-Identifier: Apache-2.0
#pragma once

#if defined(__x86_64__) || defined(__i386__) || defined(_M_X64)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace raycontact {

/// Sets rounding to nearest and keeps denormals for as long as it lives: a caller may have set other modes, and one
/// flushed denormal would change a hash.
class FloatEnvironment {
public:
    FloatEnvironment(const FloatEnvironment&) = delete;
    FloatEnvironment& operator=(const FloatEnvironment&) = delete;

#if defined(__x86_64__) || defined(__i386__) || defined(_M_X64)
    FloatEnvironment() : saved_(_mm_getcsr()) {
        _mm_setcsr(0x1f80u);
    }
    ~FloatEnvironment() {
        _mm_setcsr(saved_);
    }

private:
    unsigned saved_;
#else
    FloatEnvironment() {
        std::fegetenv(&saved_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~FloatEnvironment() {
        std::fesetenv(&saved_);
    }

private:
    std::fenv_t saved_;
#endif
};

} // namespace raycontact
