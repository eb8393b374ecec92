// SPDX-License-Identifier: Apache-2.0
// The text of the kernels once more, in a dialect whose numbers count. As on a GPU a group is one ray.
#include "bench/device/counted_kernels.h"

#include "bench/device/counted.h"

#include <algorithm>
#include <cmath>
#include <utility>

#define KERNEL inline
#define DEVICE [[maybe_unused]] static inline
#define DEVICE_CALL DEVICE
#define DEVICE_BATCH DEVICE
#define GLOBAL
#define RESTRICT
#define IN_LINES alignas(64)
#define PLACE(type) const type*
#define AT(memory, type, place)                                                                                        \
    ((void)(memory), model.load(&(place), sizeof(place)), reinterpret_cast<const type*>(place))
#define PREFETCH(array, index) ((void)(index))
#define COUNT(n) [[maybe_unused]] Range range, [[maybe_unused]] uint n
#define ALL(n) (n)
#define FOR_EACH(i, n) for (uint i = range.begin, i##_end = range.end < (n) ? range.end : (n); i < i##_end; ++i)
#define FOR_EACH_FEW(i, few, most, n)                                                                                  \
    for (uint i = range.begin, few = 1, i##_end = range.end < (n) ? range.end : (n); i < i##_end; ++i)
#define RAYS_AT_ONCE 1
#define RAYS_IN_GROUP 1
#define VERTICES_AT_ONCE 16
#define FOR_EACH_VERTICES(i, first, n)                                                                                 \
    for (uint i = range.begin, first = 0, i##_end = range.end < (n) ? range.end : (n); i < i##_end; ++i)
#define ADD_TO(place, number) ((void)(*(place) += (number)))
#define FOR_LANES(k, n) for (int k = (model.lanes(__func__), 0); k < (n); ++k)

namespace raycontact::bench::counted {

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
DEVICE Float magnitude_of(const Float& x) {
    return std::fabs(x.read());
}
DEVICE Float root_of(const Float& x) {
    model.operation();
    return std::sqrt(x.read());
}
DEVICE Float component(uint axis, const Float& x, const Float& y, const Float& z) {
    return axis == 0 ? x : axis == 1 ? y : z;
}
DEVICE uint pack_sixteen(const int* lanes) {
    uint bits = 0;
    for (int k = 0; k < 16; ++k) bits |= static_cast<uint>(lanes[k]) & (1u << k);
    return bits;
}
DEVICE uint pack_vertices(const int* lanes) {
    return pack_sixteen(lanes);
}
// One fused multiply-add.
DEVICE Float product_error(const Float& a, const Float& b, const Float& p) {
    model.operation(2);
    return std::fma(a.read(), b.read(), -p.read());
}

#define float Float
#define uint Word
#include "kernels/types.h"
#undef uint
#undef READS
#define READS(type) Reads<type>

// Structs that kernels copy whole, and so read without a word that counts itself.
template <>
inline const Ray& Reads<Ray>::operator[](std::size_t i) const {
    model.load(first_ + i, sizeof(Ray));
    return first_[i];
}
template <>
inline const Face& Reads<Face>::operator[](std::size_t i) const {
    ++model.cost.faces;
    model.load(first_ + i, sizeof(Face));
    return first_[i];
}

// clang-format off
#include "kernels/triangle.h"
#include "kernels/traverse.h"
#include "kernels/source_ray.h"
#include "kernels/ray_group.h"
#include "kernels/traverse_group.h"
#include "kernels/vertex_lanes.h"
#include "kernels/clearance.h"
#include "kernels/find_clusters.h"
#include "kernels/find_vertices.h"
#include "kernels/cast_rays.h"
#include "kernels/follow.h"
// clang-format on
#undef float

namespace {

template <class Parameter>
struct Taken {
    static Parameter from(const RawArgument& argument) { return argument.number; }
};
template <class T>
struct Taken<T*> {
    static T* from(const RawArgument& argument) { return static_cast<T*>(argument.memory); }
};
template <class T>
struct Taken<Reads<T>> {
    static Reads<T> from(const RawArgument& argument) { return static_cast<const T*>(argument.memory); }
};

template <class... Parameters>
void call(void (*kernel)(Range, uint, Parameters...), uint item, uint count, std::span<const RawArgument> arguments) {
    [&]<std::size_t... i>(std::index_sequence<i...>) {
        kernel({item, item + 1}, count, Taken<Parameters>::from(arguments[i])...);
    }
    (std::index_sequence_for<Parameters...>{});
}

void run(RayKernel kernel, uint item, uint count, std::span<const RawArgument> arguments) {
    switch (kernel) {
    case RayKernel::cast_rays_bvh:
        return call(&cast_rays_bvh, item, count, arguments);
    case RayKernel::cast_rays_basic:
        return call(&cast_rays_basic, item, count, arguments);
    case RayKernel::follow_rays_bvh:
        return call(&follow_rays_bvh, item, count, arguments);
    case RayKernel::follow_rays_basic:
        return call(&follow_rays_basic, item, count, arguments);
    }
}

} // namespace

} // namespace raycontact::bench::counted

namespace raycontact::bench {

RayCost count_ray(RayKernel kernel, std::uint32_t item, std::uint32_t count, std::span<const RawArgument> arguments) {
    counted::model = {};
    counted::model.stack = static_cast<const char*>(__builtin_frame_address(0));
    counted::run(kernel, item, count, arguments);
    auto& sectors = counted::model.cost.sectors;
    std::sort(sectors.begin(), sectors.end());
    sectors.erase(std::unique(sectors.begin(), sectors.end()), sectors.end());
    return std::move(counted::model.cost);
}

bool was_cast(std::span<const RawArgument> arguments, std::uint32_t item) {
    return (static_cast<const std::uint32_t*>(arguments.back().memory)[item] & CAST) != 0;
}

} // namespace raycontact::bench
