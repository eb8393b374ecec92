// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/adjacency.h"
#include "mesh/vector.h"

#include <span>
#include <vector>

namespace raycontact {

/// A sum in twice the precision of double (after Knuth), so that the order of its terms does not show.
class LongSum {
public:
    void add(double x);
    double value() const { return sum_ + rest_; }

private:
    double sum_ = 0, rest_ = 0;
};

struct Box {
    Vec3 low, high;
};
Box box_of(std::span<const Vec3> points);

/// Signed volume of the tetrahedron from a near point to a triangle: summed over a closed surface it is the volume,
/// m^3.
double tetrahedron(const Vec3& near, const Vec3& a, const Vec3& b, const Vec3& c);

double area_of(std::span<const Vec3> vertices, std::span<const Triangle> triangles);
double volume_of(std::span<const Vec3> vertices, std::span<const Triangle> triangles);

} // namespace raycontact
