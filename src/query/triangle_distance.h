// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"

#include <array>
#include <limits>
#include <optional>

namespace raycontact {

using Corners = std::array<Vec3, 3>;

/// Two points and their squared distance, m^2.
struct Span {
    double squared = std::numeric_limits<double>::infinity();
    Vec3 a, b;

    void shorten(const Vec3& to_a, const Vec3& to_b) {
        const Vec3 off = to_a - to_b;
        if (dot(off, off) < squared) *this = {dot(off, off), to_a, to_b};
    }
};

/// A triangle with what its distance from others needs.
struct Face {
    Corners corner, edge;
    Vec3 normal; ///< twice the area long; zero of a needle, whose normal is not accurate and whose edges are enough

    explicit Face(const Corners& corners);
};

/// Of triangles that do not meet: between two edges, or from a corner of one to the face of the other. Between edges
/// parallel to some 1e-8 the distance is within 1e-8 of their length.
void shorten_between(Span& span, const Face& p, const Face& q);

/// Where the segment of a round shape, the corners 0 and 1 of a triangle without an area, goes through a face; of its
/// edges shorten_between() knows.
std::optional<Vec3> crossing_of(const Face& segment, const Face& face);

} // namespace raycontact
