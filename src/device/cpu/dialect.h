// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#if defined(__SSE2__) || defined(_M_X64)
#include <immintrin.h>
#endif
#if !defined(__GNUC__) && !defined(__clang__)
#include <cmath>
#include <intrin.h>
#endif

// The kernel dialect in C++. The FOR_EACH loops run over the slice of a thread; FOR_LANES promises that lanes do not
// depend on each other. The device reads the number of items before it hands out slices.
namespace raycontact::kernels {
using uint = std::uint32_t;
using ulong = std::uint64_t;
struct Range {
    uint begin, end;
};
} // namespace raycontact::kernels

#define KERNEL inline
#if defined(__GNUC__) || defined(__clang__)
#define DEVICE [[maybe_unused, gnu::always_inline]] static inline
#define DEVICE_BATCH [[maybe_unused, gnu::noinline]] static // called once for many rays or blocks, or rarely
#define PREFETCH(array, index) __builtin_prefetch((array) + (index))
#else // as Microsoft's compiler has it
#define DEVICE [[maybe_unused]] static __forceinline
#define DEVICE_BATCH [[maybe_unused]] static __declspec(noinline)
#ifdef _M_X64
#define PREFETCH(array, index) _mm_prefetch(reinterpret_cast<const char*>((array) + (index)), _MM_HINT_T0)
#else
#define PREFETCH(array, index) ((void)((array) + (index)))
#endif
#endif
#define DEVICE_CALL DEVICE // not inlined where that takes a compiler minutes (NVRTC)
#define GLOBAL
#define IN_LINES alignas(64)
#define AT(memory, type, place) at_place<type>(memory, place)
#define RESTRICT __restrict
#define COUNT(n) [[maybe_unused]] Range range, [[maybe_unused]] uint n
#define ALL(n) (n)
#define FOR_EACH(i, n) for (uint i = range.begin, i##_end = range.end < (n) ? range.end : (n); i < i##_end; ++i)
#define RAYS_AT_ONCE 4
#define RAYS_IN_GROUP 16
#define VERTICES_AT_ONCE 16
#define FOR_EACH_VERTICES(i, first, n)                                                                                 \
    for (uint i = range.begin, first = 0, i##_end = range.end < (n) ? range.end : (n); i < i##_end; ++i)
#define ADD_TO(place, number) ((void)(*(place) += (number)))
#define MIN_TO(place, number) ((void)(*(place) = (number) < *(place) ? (number) : *(place)))
#define FOR_EACH_FEW(i, few, most, n)                                                                                  \
    for (uint i = range.begin, few = 0, i##_end = range.end < (n) ? range.end : (n);                                   \
         i < i##_end && (few = i##_end - i < (most) ? i##_end - i : (most)) != 0; i += few)
#if defined(__clang__)
#define FOR_LANES(k, n) _Pragma("clang loop vectorize(assume_safety)") for (int k = 0; k < (n); ++k)
#elif defined(__GNUC__)
#define FOR_LANES(k, n) _Pragma("GCC ivdep") for (int k = 0; k < (n); ++k)
#else
#define FOR_LANES(k, n) __pragma(loop(ivdep)) for (int k = 0; k < (n); ++k)
#endif

namespace raycontact::kernels {
template <class T>
DEVICE const T* at_place(const ulong* memory, ulong place) {
    // By numbers: `memory` may be null, from which no offset is allowed.
    return reinterpret_cast<const T*>(reinterpret_cast<std::uintptr_t>(memory) + sizeof(ulong) * place);
}
#if defined(__GNUC__) || defined(__clang__)
DEVICE uint lowest_bit(uint bits) {
    return static_cast<uint>(__builtin_ctz(bits));
}
DEVICE uint lowest_bit_of_long(ulong bits) {
    return static_cast<uint>(__builtin_ctzll(bits));
}
DEVICE uint bit_count(uint bits) {
    return static_cast<uint>(__builtin_popcount(bits));
}
DEVICE uint bit_count_of_long(ulong bits) {
    return static_cast<uint>(__builtin_popcountll(bits));
}
DEVICE float magnitude_of(float x) {
    return __builtin_fabsf(x);
}
DEVICE float root_of(float x) {
    return __builtin_sqrtf(x);
}
#else
// No inline function of another header, of which the linker might keep the copy for another instruction set.
DEVICE uint lowest_bit(uint bits) {
    unsigned long at;
    _BitScanForward(&at, bits);
    return at;
}
DEVICE uint lowest_bit_of_long(ulong bits) {
    const uint low = static_cast<uint>(bits);
    return low != 0 ? lowest_bit(low) : 32 + lowest_bit(static_cast<uint>(bits >> 32));
}
DEVICE uint bit_count(uint bits) {
    bits -= bits >> 1 & 0x55555555u;
    bits = (bits & 0x33333333u) + (bits >> 2 & 0x33333333u);
    return ((bits + (bits >> 4)) & 0x0f0f0f0fu) * 0x01010101u >> 24;
}
DEVICE uint bit_count_of_long(ulong bits) {
    return bit_count(static_cast<uint>(bits)) + bit_count(static_cast<uint>(bits >> 32));
}
DEVICE float magnitude_of(float x) {
    return __builtin_bit_cast(float, __builtin_bit_cast(uint, x) & 0x7fffffffu);
}
DEVICE float root_of(float x) {
    return ::sqrtf(x);
}
#endif
// By masks: compilers would turn repeated conditions into branches, which lanes cannot take.
DEVICE float component(uint axis, float x, float y, float z) {
    const uint is_x = 0U - static_cast<uint>(axis == 0), is_y = 0U - static_cast<uint>(axis == 1);
    const uint is_z = 0U - static_cast<uint>(axis == 2);
    return __builtin_bit_cast(float, (__builtin_bit_cast(uint, x) & is_x) | (__builtin_bit_cast(uint, y) & is_y)
                                         | (__builtin_bit_cast(uint, z) & is_z));
}
} // namespace raycontact::kernels
