// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact::bench {

/// What one ray took. An operation is an addition, subtraction, multiplication, division, root or comparison of float32
/// numbers; a fused multiply-add is two. Copies, signs, selections and whole numbers are not counted.
struct RayCost {
    std::uint64_t operations = 0;
    std::uint64_t nodes = 0, blocks = 0; ///< visited, of the BVH and of sixteen triangles each
    std::uint64_t faces = 0;             ///< walked over
    std::uint64_t loaded = 0;            ///< bytes, each as often as it is read
    std::vector<std::uintptr_t> sectors; ///< read from, of 32 bytes, each once, ascending
};
constexpr std::uint64_t sector_bytes = 32;

/// The kernels of which rays are counted.
enum class RayKernel { cast_rays_bvh, cast_rays_basic, follow_rays_bvh, follow_rays_basic };

/// An argument as the kernel takes it: host memory or a number.
struct RawArgument {
    void* memory = nullptr;
    std::uint32_t number = 0;
};

/// Runs one item of a kernel, its very text, with numbers that count themselves, one ray at a time as on a GPU. Writes
/// the results that the kernel writes.
RayCost count_ray(RayKernel kernel, std::uint32_t item, std::uint32_t count, std::span<const RawArgument> arguments);

/// Whether a ray of a follow_rays kernel was cast, from the kernel's last argument (Outcome.how of kernels/follow.h).
bool was_cast(std::span<const RawArgument> arguments, std::uint32_t item);

} // namespace raycontact::bench
