// SPDX-License-Identifier: Apache-2.0
#include "mesh/measure.h"

#include <algorithm>

namespace raycontact {

void LongSum::add(double x) {
    const double sum = sum_ + x;
    const double shadow = sum - sum_;
    rest_ += (sum_ - (sum - shadow)) + (x - shadow);
    sum_ = sum;
}

Box box_of(std::span<const Vec3> points) {
    Box box{points.front(), points.front()};
    for (const Vec3& p : points) {
        box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
        box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
    }
    return box;
}

double tetrahedron(const Vec3& near, const Vec3& a, const Vec3& b, const Vec3& c) {
    return dot(a - near, cross(b - near, c - near)) / 6;
}

double area_of(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
    LongSum sum;
    for (const auto& [a, b, c] : triangles)
        sum.add(length(cross(vertices[b] - vertices[a], vertices[c] - vertices[a])) / 2);
    return sum.value();
}

double volume_of(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
    const Box box = box_of(vertices);
    const Vec3 near = 0.5 * (box.low + box.high);
    LongSum sum;
    for (const auto& [a, b, c] : triangles) sum.add(tetrahedron(near, vertices[a], vertices[b], vertices[c]));
    return sum.value();
}

} // namespace raycontact
