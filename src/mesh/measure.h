// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/adjacency.h"
#include "mesh/vector.h"

#include <span>

namespace raycontact {

/// A sum in twice the precision of double (after Knuth), so that the order of its terms does not matter.
class LongSum {
public:
    void add(double x);
    double value() const { return sum_ + rest_; }

private:
    double sum_ = 0, rest_ = 0;
};

struct Box {
    Vec3 low, high;
    Vec3 middle() const { return 0.5 * (low + high); }
    void add(const Box& other) { *this = {least(low, other.low), most(high, other.high)}; }
    double squared_distance(const Vec3& p) const {
        const Vec3 off = most(most(low - p, p - high), Vec3{});
        return dot(off, off);
    }
    bool touches(const Box& other) const {
        return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y && other.low.y <= high.y
               && low.z <= other.high.z && other.low.z <= high.z;
    }
};
Box box_of(std::span<const Vec3> points);

/// Mass's volume alone; 0 of no triangles.
double volume_of(std::span<const Vec3> vertices, std::span<const Triangle> triangles);

} // namespace raycontact
