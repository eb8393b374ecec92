// SPDX-License-Identifier: Apache-2.0
#include "columns.h"

#include <raycontact/error.h>

#include <string>

namespace raycontact::python {

std::size_t items_of(std::initializer_list<std::pair<const char*, std::size_t>> lists) {
    std::pair<const char*, std::size_t> longest{"", 1};
    for (const auto& list : lists) {
        if (list.second == 1 || list.second == longest.second) continue;
        if (longest.second != 1)
            throw InputError(std::string(list.first) + ": " + std::to_string(list.second) + " given, and "
                             + std::to_string(longest.second) + " of " + longest.first + "; give as many, or one");
        longest = list;
    }
    return longest.second;
}

void RayHitColumns::set(std::size_t i, const RayHit& hit) {
    distance.set(i, hit.distance);
    point.set(i, hit.point);
    normal.set(i, hit.normal);
    triangle.set_triangle(i, hit.triangle);
}
nb::tuple RayHitColumns::take() {
    return nb::make_tuple(distance.take(), point.take(), normal.take(), triangle.take());
}

void DistanceColumns::set(std::size_t i, const Distance& found) {
    distance.set(i, found.distance);
    point_a.set(i, found.point_a);
    point_b.set(i, found.point_b);
    triangle_a.set_triangle(i, found.triangle_a);
    triangle_b.set_triangle(i, found.triangle_b);
}

nb::tuple DistanceColumns::take() {
    return nb::make_tuple(distance.take(), point_a.take(), point_b.take(), triangle_a.take(), triangle_b.take());
}

void ImpactColumns::set(std::size_t i, const Impact& found) {
    time.set(i, found.time);
    distance.set(i, found.distance);
    point_a.set(i, found.point_a);
    point_b.set(i, found.point_b);
    normal.set(i, found.normal);
    triangle_a.set_triangle(i, found.triangle_a);
    triangle_b.set_triangle(i, found.triangle_b);
}
nb::tuple ImpactColumns::take() {
    return nb::make_tuple(time.take(), distance.take(), point_a.take(), point_b.take(), normal.take(),
                          triangle_a.take(), triangle_b.take());
}

void ClosestPointColumns::set(std::size_t i, const ClosestPoint& found) {
    distance.set(i, found.distance);
    point.set(i, found.point);
    triangle.set_triangle(i, found.triangle);
}
nb::tuple ClosestPointColumns::take() {
    return nb::make_tuple(distance.take(), point.take(), triangle.take());
}

} // namespace raycontact::python
