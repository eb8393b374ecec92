// SPDX-License-Identifier: Apache-2.0
#include "exact/rational_mesh.h"

// CGAL's headers are not written for these warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <CGAL/Exact_rational.h>
#include <CGAL/Lazy_exact_nt.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/squared_distance_3.h>
#pragma GCC diagnostic pop

#include <array>
#include <cmath>
#include <vector>

namespace raycontact::exact {

namespace {

using Number = CGAL::Lazy_exact_nt<CGAL::Exact_rational>; // intervals first
using Kernel = CGAL::Simple_cartesian<Number>;
using Point = Kernel::Point_3;
using Vector = Kernel::Vector_3;

Point point_of(const Vec3& v) {
    return {v.x, v.y, v.z};
}

/// The least of what was added.
struct Nearest {
    std::optional<Number> least;
    std::uint32_t triangle = 0, ties = 0;

    void add(const Number& value, std::uint32_t of) {
        if (least && value > *least) return;
        if (!least || value < *least) {
            least = value;
            triangle = of;
            ties = 0;
        }
        triangle = std::min(triangle, of);
        ++ties;
    }
};

} // namespace

struct RationalMesh::State {
    std::vector<std::array<Point, 3>> triangles;
    std::vector<std::uint32_t> index;
};

RationalMesh::RationalMesh(const Shape& shape, const Pose& pose) : state_(std::make_unique<State>()) {
    std::vector<Point> points;
    for (const Vec3& v : shape.file_vertices()) points.push_back(point_of(transform_point(pose, v)));
    for (const auto& t : shape.triangles()) state_->triangles.push_back({points[t[0]], points[t[1]], points[t[2]]});
    state_->index.assign(shape.triangle_index().begin(), shape.triangle_index().end());
}

RationalMesh::~RationalMesh() = default;

std::optional<RationalMesh::Found> RationalMesh::raycast(const Vec3& origin, const Vec3& direction) const {
    const Point from = point_of(origin);
    const Vector way(direction.x, direction.y, direction.z);
    Nearest nearest;
    for (std::size_t i = 0; i < state_->triangles.size(); ++i) {
        const auto& t = state_->triangles[i];
        const Vector normal = CGAL::cross_product(t[1] - t[0], t[2] - t[0]);
        const Number fall = normal * way;
        if (fall == 0) continue;
        const Number at = normal * (t[0] - from) / fall;
        if (at < 0 || (nearest.least && at > *nearest.least)) continue;
        const Point hit = from + at * way;
        bool inside = true;
        for (std::size_t k = 0; k < 3 && inside; ++k)
            inside = normal * CGAL::cross_product(t[(k + 1) % 3] - t[k], hit - t[k]) >= 0;
        if (inside) nearest.add(at, state_->index[i]);
    }
    if (!nearest.least) return std::nullopt;
    return Found{nearest.triangle, CGAL::to_double(*nearest.least), nearest.ties};
}

RationalMesh::Found RationalMesh::closest(const Vec3& point) const {
    const Point sought = point_of(point);
    Nearest nearest;
    for (std::size_t i = 0; i < state_->triangles.size(); ++i) {
        const auto& t = state_->triangles[i];
        nearest.add(CGAL::squared_distance(sought, Kernel::Triangle_3(t[0], t[1], t[2])), state_->index[i]);
    }
    return {nearest.triangle, std::sqrt(CGAL::to_double(*nearest.least)), nearest.ties};
}

} // namespace raycontact::exact
