// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/library_mode.h>

namespace raycontact {

/// A point or direction in double precision; metres or unitless, the frame is said where it is used.
struct Vec3 {
    double x = 0; ///< first coordinate
    double y = 0; ///< second coordinate
    double z = 0; ///< third coordinate
    friend bool operator==(const Vec3&, const Vec3&) = default;
};

/// The same in single precision, where no more is known. Converts to Vec3, which loses nothing.
struct Vec3f {
    float x = 0; ///< first coordinate
    float y = 0; ///< second coordinate
    float z = 0; ///< third coordinate
    /// Exact.
    constexpr operator Vec3() const noexcept { return {double(x), double(y), double(z)}; }
    friend bool operator==(const Vec3f&, const Vec3f&) = default;
};

} // namespace raycontact
