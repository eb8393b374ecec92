// SPDX-License-Identifier: Apache-2.0
// The kernels' words in CUDA C++, for NVRTC with --fmad=false --prec-div=true --prec-sqrt=true --ftz=false.
typedef unsigned int uint;
typedef unsigned long long ulong;

#define KERNEL extern "C" __global__
#define DEVICE static inline __device__
#define DEVICE_CALL static __noinline__ __device__
#define DEVICE_BATCH DEVICE
#define GLOBAL
#define IN_LINES
#define PLACE(type) ulong
#define AT(memory, type, place) ((GLOBAL const type*)((memory) + (place)))
#define RESTRICT __restrict__
#define PREFETCH(array, index) ((void)(index))
#define COUNT(n) const uint *RESTRICT n##_counts, uint n##_value
#define ALL(n) (n##_counts ? n##_counts[n##_value] : n##_value)
#define FOR_EACH(i, n)                                                                                                 \
    for (uint i = blockIdx.x * blockDim.x + threadIdx.x, i##_end = ALL(n); i < i##_end; i += gridDim.x * blockDim.x)
#define VERTICES_AT_ONCE 1
#define FOR_EACH_VERTICES(i, first, n)                                                                                 \
    for (uint v = blockIdx.x * blockDim.x + threadIdx.x, v_end = VERTEX_LANES * ALL(n), i = v / VERTEX_LANES,          \
              first = v % VERTEX_LANES;                                                                                \
         v < v_end; v += gridDim.x * blockDim.x, i = v / VERTEX_LANES, first = v % VERTEX_LANES)
#define ADD_TO(place, number) ((void)atomicAdd(place, number))
#define MIN_TO(place, number) ((void)atomicMin(place, number))
#define RAYS_AT_ONCE 1
#define RAYS_IN_GROUP 1
#define FOR_EACH_FEW(i, few, most, n)                                                                                  \
    for (uint i = blockIdx.x * blockDim.x + threadIdx.x, few = 1u, i##_end = ALL(n); i < i##_end;                      \
         i += gridDim.x * blockDim.x)
#define FOR_LANES(k, n) for (int k = 0; k < (n); ++k)

// Of kernels whose threads work together (gpu/scan.h).
#define SCAN_GROUP 1024u
#define GROUP_KERNEL extern "C" __global__ __launch_bounds__(SCAN_GROUP)
#define GROUP blockIdx.x
#define GROUPS gridDim.x
#define THREAD threadIdx.x
#define LOCAL
#define SHARED(type, name, size) __shared__ type name[size]
#define BARRIER __syncthreads()

DEVICE uint lowest_bit(uint bits) {
    return (uint)__ffs((int)bits) - 1u;
}
DEVICE uint lowest_bit_of_long(ulong bits) {
    return (uint)__ffsll((long long)bits) - 1u;
}
DEVICE uint bit_count(uint bits) {
    return (uint)__popc(bits);
}
DEVICE uint bit_count_of_long(ulong bits) {
    return (uint)__popcll(bits);
}
DEVICE float magnitude_of(float x) {
    return fabsf(x);
}
DEVICE float root_of(float x) {
    return __fsqrt_rn(x);
}
DEVICE float component(uint axis, float x, float y, float z) {
    return axis == 0u ? x : axis == 1u ? y : z;
}
DEVICE uint pack_sixteen(const int* lanes) {
    uint bits = 0u;
    for (int k = 0; k < 16; ++k) bits |= (uint)lanes[k] & (1u << k);
    return bits;
}
DEVICE uint pack_vertices(const int* lanes) {
    return (uint)lanes[0] & 1u;
}

// What rounding took from p = fl(a * b), exactly; the only fused multiply-add there is.
DEVICE float product_error(float a, float b, float p) {
    return __fmaf_rn(a, b, -p);
}
