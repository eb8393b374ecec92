// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include <cstdint>

namespace raycontact::reference {

/// By splitmix64: the same numbers from every compiler and standard library.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    std::uint64_t bits();
    double uniform(); ///< [0, 1)
    double uniform(double low, double high);
    std::uint32_t below(std::uint32_t count);
    Vec3 in_ball();   ///< uniform in the unit ball
    Vec3 direction(); ///< uniform on the unit sphere
    Pose rotation();  ///< uniform rotation, no translation; no trigonometry

private:
    std::uint64_t state_;
};

/// A rotation about `axis` (unit) by a small angle in radians, orthonormal to rounding.
Pose small_rotation(const Vec3& axis, double angle);

} // namespace raycontact::reference
