// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <recording/reader.h>

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace raycontact::view {

/// Poses of all bodies at some steps, 16 bits a number: translations over the box of all of them, quaternions over
/// [-1, 1].
struct Motion {
    std::array<double, 3> low{}, high{}; ///< metres, world frame
    std::uint32_t stride = 1;            ///< steps between two that are kept; the first is step 0
    std::uint32_t kept = 0;              ///< steps
    std::uint32_t bodies = 0;            ///< every body there ever was
    std::vector<bool> moves;             ///< by body: false for one whose pose is the same in all of several steps
    std::vector<std::uint16_t> numbers;  ///< [body][number][kept step]; x y z, then the quaternion x y z w
};
constexpr std::uint32_t numbers_a_pose = 7;

/// The smallest stride that keeps bodies times steps within `poses`.
std::uint32_t stride_for(std::uint32_t bodies, std::uint32_t steps, std::uint64_t poses);
/// Where a body is not there, its pose is that of the nearest step in which it is. Throws InputError for a damaged
/// file.
Motion read_motion(recording::Reader& reader, std::uint32_t stride, const std::function<void(std::uint32_t)>& progress);
/// Of a run whose bodies come one after another and stay: of every stride-th step from step 0 the poses of those that
/// have come. moves: by body, of all that come.
Motion motion_of(const std::vector<std::vector<Pose>>& steps, std::uint32_t stride, const std::vector<bool>& moves);
/// Of bodies that stand still, in one step.
Motion standing(std::span<const Pose> poses);
/// What the page adds up again: each number minus that of the kept step before.
std::vector<std::uint16_t> differences(const Motion& motion);

} // namespace raycontact::view
