// SPDX-License-Identifier: Apache-2.0
#include "clash/duplicates.h"

#include "clash/askew.h"

#include "mesh/vector.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace raycontact::clash {

namespace {

// Mostly this one vertex tells them apart.
bool has_first_vertex(const Part& b, const Part& a, double tolerance) {
    const Vec3 sought = transform_point(relative_pose(b.pose, a.pose), a.shape->vertices()[0]);
    return std::ranges::any_of(b.shape->vertices(), [&](const Vec3& v) { return length(v - sought) <= 2 * tolerance; });
}

std::vector<double> sorted_heights(const Part& part, const Vec3& origin, const Vec3& direction) {
    std::vector<double> heights;
    heights.reserve(part.shape->vertices().size());
    for (const Vec3& v : part.shape->vertices())
        heights.push_back(dot(transform_point(part.pose, v) - origin, direction));
    std::sort(heights.begin(), heights.end());
    return heights;
}

} // namespace

// Points that agree to a tolerance have heights along any direction that agree, sorted, to that tolerance, whatever
// their order; others differ along one of several directions that no mesh follows.
bool are_duplicates(const Part& a, const Part& b) {
    if (a.shape->vertices().size() != b.shape->vertices().size()
        || a.shape->triangles().size() != b.shape->triangles().size())
        return false;
    const double tolerance = 1e-6 * smaller_size(a, b);
    if (!has_first_vertex(b, a, tolerance)) return false;
    const Vec3 origin = transform_point(a.pose, a.shape->centre());
    return std::ranges::all_of(askew, [&](const Vec3& direction) {
        return std::ranges::equal(sorted_heights(a, origin, direction), sorted_heights(b, origin, direction),
                                  [&](double p, double q) { return std::fabs(p - q) <= tolerance; });
    });
}

} // namespace raycontact::clash
