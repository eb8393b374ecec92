// SPDX-License-Identifier: Apache-2.0
// The kernel dialect in OpenCL C 1.2. The text itself turns contraction off, whatever the build options are.
#pragma OPENCL FP_CONTRACT OFF

#define KERNEL __kernel
#define DEVICE static inline
#define DEVICE_CALL DEVICE
#define DEVICE_BATCH DEVICE
#define GLOBAL __global
#define IN_LINES
#define PLACE(type) ulong
#define AT(memory, type, place) ((GLOBAL const type*)((memory) + (place)))
#define RESTRICT restrict
#define PREFETCH(array, index) ((void)(index))
#define COUNT(n) GLOBAL const uint *RESTRICT n##_counts, uint n##_value
#define ALL(n) (n##_counts ? n##_counts[n##_value] : n##_value)
#define FOR_EACH(i, n)                                                                                                 \
    for (uint i = (uint)get_global_id(0), i##_end = ALL(n); i < i##_end; i += (uint)get_global_size(0))
// VERTICES_AT_ONCE is a build option (Source::vertices_at_once).
#define BLOCK_ITEMS (VERTEX_LANES / VERTICES_AT_ONCE)
#define FOR_EACH_VERTICES(i, first, n)                                                                                 \
    for (uint v = (uint)get_global_id(0), v_end = BLOCK_ITEMS * ALL(n), i = v / BLOCK_ITEMS,                           \
              first = v % BLOCK_ITEMS * VERTICES_AT_ONCE;                                                              \
         v < v_end; v += (uint)get_global_size(0), i = v / BLOCK_ITEMS, first = v % BLOCK_ITEMS * VERTICES_AT_ONCE)
#define ADD_TO(place, number) ((void)atomic_add(place, number))
#define MIN_TO(place, number) ((void)atomic_min(place, number))
#define RAYS_AT_ONCE 1
#define RAYS_IN_GROUP 1
#define FOR_EACH_FEW(i, few, most, n)                                                                                  \
    for (uint i = (uint)get_global_id(0), few = 1u, i##_end = ALL(n); i < i##_end; i += (uint)get_global_size(0))
#define FOR_LANES(k, n) for (int k = 0; k < (n); ++k)

// For kernels whose threads work together (gpu/scan.h).
#define SCAN_GROUP 256u
#define GROUP_KERNEL __kernel __attribute__((reqd_work_group_size(SCAN_GROUP, 1, 1)))
#define GROUP ((uint)get_group_id(0))
#define GROUPS ((uint)get_num_groups(0))
#define THREAD ((uint)get_local_id(0))
#define LOCAL __local
#define SHARED(type, name, size) __local type name[size]
#define BARRIER barrier(CLK_LOCAL_MEM_FENCE)

DEVICE uint lowest_bit(uint bits) {
    return 31u - clz(bits & (0u - bits));
}
DEVICE uint lowest_bit_of_long(ulong bits) {
    return (uint)(63ul - clz(bits & (0ul - bits)));
}
DEVICE uint bit_count(uint bits) {
    return popcount(bits);
}
DEVICE uint bit_count_of_long(ulong bits) {
    return (uint)popcount(bits);
}
DEVICE float magnitude_of(float x) {
    return fabs(x);
}
DEVICE float root_of(float x) {
    return sqrt(x);
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
    uint bits = 0u;
    for (int k = 0; k < VERTICES_AT_ONCE; ++k) bits |= (uint)lanes[k] & (1u << k);
    return bits;
}

// The exact rounding error of p = fl(a * b): fma() rounds once on every device, though slowly on some.
DEVICE float product_error(float a, float b, float p) {
    return fma(a, b, -p);
}
