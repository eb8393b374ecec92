// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/exact_vector.h"

#include <raycontact/pose.h>

#include <array>
#include <cstddef>

namespace raycontact {

/// Where a mesh lies, in the world's axes about some origin: rotation * x + shift + shift_rest, in real numbers.
struct Placing {
    std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1}; ///< entries below 1e-36 count as 0
    Vec3 shift, shift_rest;                                    ///< metres; the rest is below the last bit of the shift
    bool by_quarters = true;                                   ///< only entries of 0, 1 and -1
    double error = 0;                                          ///< of `rough` of its points, metres, at most

    Placing() = default;
    Placing(const std::array<double, 9>& rotation, const Vec3& translation, const Vec3& origin);
};

/// A point of a mesh, placed. Predicates decide it exactly: by `rough` where its error does not matter, else for the
/// real numbers that the placing stands for (Shewchuk 1997).
struct PlacedPoint {
    Vec3 rough; ///< in any frame that all points asked about share, metres
    Vec3 own;   ///< in its own frame, metres; coordinates below 1e-36 are 0 (own_point())
    const Placing* placing;
};

/// Where it lies along the world's axes, exactly.
ExactVec3 exact_place(const PlacedPoint& point);

/// Coordinates below 1e-36 m count as 0: the products of three, with the last bit of each, then stay exact.
Vec3 own_point(const Vec3& point);

// As those of predicates.h; axes are the world's.
int orient3d(const PlacedPoint& a, const PlacedPoint& b, const PlacedPoint& c, const PlacedPoint& d);
int orient2d(const PlacedPoint& a, const PlacedPoint& b, const PlacedPoint& c, std::size_t drop);
int order(const PlacedPoint& a, const PlacedPoint& b, std::size_t k);

} // namespace raycontact
