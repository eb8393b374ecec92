// SPDX-License-Identifier: Apache-2.0
// Questions about one item as most callers give it: a shape, float64 matrices or none. What is given otherwise, or is
// wrong, has no answer here (None): the Python half looks closer, and says what is wrong.
#include "arrays.h"
#include "bind.h"
#include "contact_bytes.h"
#include "single.h"
#include "without_gil.h"

#include <raycontact/collide.h>
#include <raycontact/query.h>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace raycontact::python {

namespace {

using Triple = nb::ndarray<const double, nb::shape<3>, nb::c_contig, nb::device::cpu>;

/// Of a float64 array (3,), a list or a tuple of three Python numbers.
std::optional<Vec3> point_of(nb::handle given) {
    std::array<double, 3> p{};
    if (nb::isinstance<nb::list>(given) || nb::isinstance<nb::tuple>(given)) {
        const auto list = nb::borrow<nb::sequence>(given);
        if (nb::len(list) != 3) return std::nullopt;
        for (std::size_t k = 0; k < 3; ++k) {
            const nb::object number = list[k];
            const bool is_number = PyFloat_Check(number.ptr()) || Py_TYPE(number.ptr()) == &PyLong_Type;
            if (!is_number || !nb::try_cast<double>(number, p[k])) return std::nullopt;
        }
    } else {
        Triple point;
        if (!nb::try_cast<Triple>(given, point, false)) return std::nullopt;
        std::copy_n(point.data(), 3, p.begin());
    }
    constexpr double largest = 1e30;
    for (const double x : p)
        if (!(std::fabs(x) < largest)) return std::nullopt;
    return Vec3{p[0], p[1], p[2]};
}

Array array_of(const Vec3& v) {
    return python::array_of(std::vector{v.x, v.y, v.z}, {3});
}

nb::object index_of(std::uint32_t triangle) {
    return nb::int_(triangle == Shape::no_triangle ? std::int64_t{-1} : std::int64_t{triangle});
}

std::optional<bool> one_intersects(const Shape& a, nb::handle given_a, const Shape& b, nb::handle given_b) {
    const auto pose_a = pose_of(given_a), pose_b = pose_of(given_b);
    if (!pose_a || !pose_b) return std::nullopt;
    const WithoutGil without_gil;
    return intersects(a, *pose_a, b, *pose_b);
}

// None, too, of words that are not known, and of pairs that are worth more threads than one.
std::optional<ReadOnlyArray> one_collide(const Shape& a, nb::handle given_a, const Shape& b, nb::handle given_b,
                                         const std::string& direction, const std::string& features) {
    constexpr std::size_t few = 1 << 15; // triangles
    const auto pose_a = pose_of(given_a), pose_b = pose_of(given_b);
    if (!pose_a || !pose_b || a.triangles().size() + b.triangles().size() > few) return std::nullopt;
    CollideOptions options;
    try {
        options.direction = direction_from(direction);
        options.features = features_from(features);
    } catch (const InputError&) {
        return std::nullopt;
    }
    auto found = std::make_shared<std::vector<Contact>>();
    {
        const WithoutGil without_gil;
        *found = collide(a, *pose_a, b, *pose_b, options);
    }
    return bytes_of(std::move(found));
}

std::optional<nb::tuple> one_distance(const Shape& a, nb::handle given_a, const Shape& b, nb::handle given_b,
                                      double max) {
    const auto pose_a = pose_of(given_a), pose_b = pose_of(given_b);
    if (!pose_a || !pose_b || !(max >= 0)) return std::nullopt;
    std::optional<Distance> found;
    {
        const WithoutGil without_gil;
        found = distance(a, *pose_a, b, *pose_b, max);
    }
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    if (!found)
        return nb::make_tuple(any_distance, array_of(Vec3{none, none, none}), array_of(Vec3{none, none, none}), -1, -1);
    return nb::make_tuple(found->distance, array_of(found->point_a), array_of(found->point_b),
                          index_of(found->triangle_a), index_of(found->triangle_b));
}

std::optional<nb::tuple> one_closest_point(const Shape& shape, nb::handle given_pose, nb::handle given_point,
                                           double max) {
    const auto pose = pose_of(given_pose);
    const auto point = point_of(given_point);
    if (!pose || !point || !(max >= 0)) return std::nullopt;
    std::optional<ClosestPoint> found;
    {
        const WithoutGil without_gil;
        found = closest_point(shape, *pose, *point, max);
    }
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    if (!found) return nb::make_tuple(any_distance, array_of(Vec3{none, none, none}), -1);
    return nb::make_tuple(found->distance, array_of(found->point), index_of(found->triangle));
}

std::optional<nb::tuple> one_signed_distance(const Shape& shape, nb::handle given_pose, nb::handle given_point) {
    const auto pose = pose_of(given_pose);
    const auto point = point_of(given_point);
    if (!pose || !point) return std::nullopt;
    SignedDistance found;
    {
        const WithoutGil without_gil;
        found = signed_distance(shape, *pose, std::span(&*point, 1), 1)[0];
    }
    return nb::make_tuple(found.distance, array_of(found.point), index_of(found.triangle), array_of(found.gradient));
}

/// A ray that is sound.
struct Ray {
    Pose pose;
    Vec3 origin, direction;
};

std::optional<Ray> ray_of(nb::handle given_pose, nb::handle given_origin, nb::handle given_direction, double max) {
    const auto pose = pose_of(given_pose);
    const auto origin = point_of(given_origin), direction = point_of(given_direction);
    if (!pose || !origin || !direction || *direction == Vec3{} || !(max >= 0)) return std::nullopt;
    return Ray{*pose, *origin, *direction};
}

std::optional<nb::tuple> one_raycast(const Shape& shape, nb::handle pose, nb::handle origin, nb::handle direction,
                                     double max) {
    const auto ray = ray_of(pose, origin, direction, max);
    if (!ray) return std::nullopt;
    std::optional<RayHit> hit;
    {
        const WithoutGil without_gil;
        hit = raycast(shape, ray->pose, ray->origin, ray->direction, max);
    }
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    if (!hit)
        return nb::make_tuple(any_distance, array_of(Vec3{none, none, none}), array_of(Vec3{none, none, none}), -1);
    return nb::make_tuple(hit->distance, array_of(hit->point), array_of(hit->normal), index_of(hit->triangle));
}

std::optional<bool> one_raycast_any(const Shape& shape, nb::handle pose, nb::handle origin, nb::handle direction,
                                    double max) {
    const auto ray = ray_of(pose, origin, direction, max);
    if (!ray) return std::nullopt;
    const WithoutGil without_gil;
    return raycast_any(shape, ray->pose, ray->origin, ray->direction, max);
}

std::optional<bool> one_contains(const Shape& shape, nb::handle given_pose, nb::handle given_point) {
    const auto pose = pose_of(given_pose);
    const auto point = point_of(given_point);
    if (!pose || !point) return std::nullopt;
    const WithoutGil without_gil;
    return contains(shape, *pose, *point);
}

} // namespace

std::optional<Pose> pose_of(nb::handle given) {
    using Matrix = nb::ndarray<const double, nb::shape<4, 4>, nb::c_contig, nb::device::cpu>;
    if (given.is_none()) return Pose{};
    Matrix matrix;
    if (!nb::try_cast<Matrix>(given, matrix, false)) return std::nullopt;
    return rigid_pose(matrix.data());
}

std::optional<Pose> rigid_pose(const double* m) {
    if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1) return std::nullopt;
    const Pose pose{{m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]}, {m[3], m[7], m[11]}};
    const auto& r = pose.rotation;
    double shear = 0;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j) {
            const double product = r[i] * r[j] + r[3 + i] * r[3 + j] + r[6 + i] * r[6 + j] - (i == j ? 1 : 0);
            shear = std::isfinite(product) ? std::max(shear, std::fabs(product)) : 1;
        }
    const double volume =
        r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) + r[2] * (r[3] * r[7] - r[4] * r[6]);
    const Vec3& t = pose.translation;
    constexpr double largest = 1e30; // check_placed() names larger ones
    const bool fits = std::fabs(t.x) < largest && std::fabs(t.y) < largest && std::fabs(t.z) < largest;
    if (!(shear <= 1e-4) || !(volume > 0) || !fits) return std::nullopt;
    return pose;
}

void bind_single(nb::module_& m) {
    const auto pose = [](const char* name) { return nb::arg(name).none(); };
    m.def(
        "are_rigid",
        [](const Matrices& matrices) {
            for (std::size_t i = 0; i < matrices.shape(0); ++i)
                if (!rigid_pose(matrices.data() + 16 * i)) return false;
            return true;
        },
        "poses"_a);
    m.def("one_intersects", &one_intersects, "a"_a, pose("pose_a"), "b"_a, pose("pose_b"));
    m.def("one_collide", &one_collide, "a"_a, pose("pose_a"), "b"_a, pose("pose_b"), "direction"_a, "features"_a);
    m.def("one_distance", &one_distance, "a"_a, pose("pose_a"), "b"_a, pose("pose_b"), "max"_a);
    m.def("one_closest_point", &one_closest_point, "shape"_a, pose("pose"), "point"_a, "max"_a);
    m.def("one_contains", &one_contains, "shape"_a, pose("pose"), "point"_a);
    m.def("one_signed_distance", &one_signed_distance, "shape"_a, pose("pose"), "point"_a);
    m.def("one_raycast", &one_raycast, "shape"_a, pose("pose"), "origin"_a, "direction"_a, "max"_a);
    m.def("one_raycast_any", &one_raycast_any, "shape"_a, pose("pose"), "origin"_a, "direction"_a, "max"_a);
}

} // namespace raycontact::python
