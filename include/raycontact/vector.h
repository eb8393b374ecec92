// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/library_mode.h>

#include <cmath>

namespace raycontact {

/// A point or direction in double precision; metres or unitless, the frame is said where it is used.
struct Vec3 {
    double x = 0; ///< first coordinate
    double y = 0; ///< second coordinate
    double z = 0; ///< third coordinate
    friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

/// The same in single precision, where no more is known. Converts to Vec3, which loses nothing.
struct Vec3f {
    float x = 0; ///< first coordinate
    float y = 0; ///< second coordinate
    float z = 0; ///< third coordinate
    /// Exact.
    constexpr operator Vec3() const noexcept { return {double(x), double(y), double(z)}; }
    friend constexpr bool operator==(const Vec3f&, const Vec3f&) = default;
};

constexpr Vec3 operator+(const Vec3& a, const Vec3& b) noexcept { ///< by coordinates
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
constexpr Vec3 operator-(const Vec3& a, const Vec3& b) noexcept { ///< by coordinates
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
constexpr Vec3 operator-(const Vec3& a) noexcept { ///< the other way
    return {-a.x, -a.y, -a.z};
}
constexpr Vec3 operator*(double s, const Vec3& a) noexcept { ///< each coordinate
    return {s * a.x, s * a.y, s * a.z};
}
constexpr Vec3 operator*(const Vec3& a, double s) noexcept { ///< each coordinate
    return s * a;
}
constexpr Vec3 operator/(const Vec3& a, double s) noexcept { ///< each coordinate
    return {a.x / s, a.y / s, a.z / s};
}
constexpr Vec3& operator+=(Vec3& a, const Vec3& b) noexcept { ///< by coordinates
    return a = a + b;
}
constexpr Vec3& operator-=(Vec3& a, const Vec3& b) noexcept { ///< by coordinates
    return a = a - b;
}
constexpr Vec3& operator*=(Vec3& a, double s) noexcept { ///< each coordinate
    return a = s * a;
}
constexpr double dot(const Vec3& a, const Vec3& b) noexcept { ///< the scalar product
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr Vec3 cross(const Vec3& a, const Vec3& b) noexcept { ///< the vector product, right-handed
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
constexpr double length2(const Vec3& a) noexcept { ///< the square of its length
    return dot(a, a);
}
inline double length(const Vec3& a) noexcept { ///< its Euclidean norm; squares that overflow are not mended
    return std::sqrt(length2(a));
}
inline Vec3 unit(const Vec3& a) noexcept { ///< of length 1; zero for a zero vector
    const double size = length(a);
    return size > 0 ? (1 / size) * a : Vec3{};
}

} // namespace raycontact
