// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace raycontact::scenes {

/// splitmix64 (Steele, Lea, Flood 2014): the same numbers from every compiler, unlike the distributions of <random>.
inline std::uint64_t splitmix64(std::uint64_t& state) {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    std::uint64_t next() { return splitmix64(state_); }
    /// In [-1, 1), a multiple of 2^-52.
    double symmetric() { return static_cast<double>(next() >> 11) * 0x1p-52 - 1; }

    /// Unit quaternion (w, x, y, z) at most `tilt` (radians, small) or so from none about each axis.
    std::array<double, 4> tilt(double tilt) {
        const double x = symmetric() * tilt / 2, y = symmetric() * tilt / 2, z = symmetric() * tilt / 2;
        const double length = std::sqrt(1 + x * x + y * y + z * z);
        return {1 / length, x / length, y / length, z / length};
    }

    /// Unit quaternion (w, x, y, z), uniform over all rotations: a point of a cube, kept where it is in the unit ball.
    std::array<double, 4> rotation() {
        for (;;) {
            const double w = symmetric(), x = symmetric(), y = symmetric(), z = symmetric();
            const double square = w * w + x * x + y * y + z * z;
            if (square > 1 || square < 0.01) continue;
            const double length = std::sqrt(square);
            return {w / length, x / length, y / length, z / length};
        }
    }

private:
    std::uint64_t state_;
};

} // namespace raycontact::scenes
