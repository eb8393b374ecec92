// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"
#include "batch.h"
#include "bind.h"

#include <raycontact/error.h>
#include <raycontact/query.h>

#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <limits>

namespace raycontact::python {

namespace {

using Shapes = std::vector<std::shared_ptr<Shape>>;

constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();

/// One for all items, or one for each.
template <typename List>
const auto& of_item(const List& list, std::size_t i) {
    return list[list.size() == 1 ? 0 : i];
}

/// How many items lists of these sizes make: one of a thing counts for all items. Throws InputError where sizes differ.
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

/// Two lists of placed shapes; what is there once counts for all.
struct PlacedPairs {
    Shapes a, b;
    std::vector<Pose> pose_a, pose_b;
    std::size_t count;
    std::uint32_t threads;

    template <typename Work>
    void for_each(const Work& work) const {
        for_each_item(count, threads, "pair", [&](std::size_t i) {
            work(i, *of_item(a, i), of_item(pose_a, i), *of_item(b, i), of_item(pose_b, i));
        });
    }
};

/// Numbers of one kind for each item.
template <typename Number>
std::vector<Number> column(std::size_t count, Number number, std::size_t width = 1) {
    return std::vector<Number>(count * width, number);
}

void put(std::vector<double>& column, std::size_t i, const Vec3& v) {
    column[3 * i] = v.x;
    column[3 * i + 1] = v.y;
    column[3 * i + 2] = v.z;
}

std::int64_t index_of(std::uint32_t triangle) {
    return triangle == Shape::no_triangle ? -1 : std::int64_t{triangle};
}

Array intersects_all(const PlacedPairs& pairs) {
    auto found = column<std::uint8_t>(pairs.count, 0);
    pairs.for_each([&](std::size_t i, const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
        found[i] = intersects(a, pose_a, b, pose_b) ? 1 : 0;
    });
    return array_of(std::move(found), {pairs.count});
}

Array common_points(const PlacedPairs& pairs) {
    auto points = column(pairs.count, nowhere, 3);
    pairs.for_each([&](std::size_t i, const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
        if (const auto point = common_point(a, pose_a, b, pose_b)) put(points, i, *point);
    });
    return array_of(std::move(points), {pairs.count, 3});
}

nb::tuple distances(const PlacedPairs& pairs, double max) {
    const std::size_t n = pairs.count;
    auto least = column(n, any_distance);
    auto point_a = column(n, nowhere, 3), point_b = column(n, nowhere, 3);
    auto triangle_a = column<std::int64_t>(n, -1), triangle_b = column<std::int64_t>(n, -1);
    pairs.for_each([&](std::size_t i, const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
        const auto found = distance(a, pose_a, b, pose_b, max);
        if (!found) return;
        least[i] = found->distance;
        put(point_a, i, found->point_a);
        put(point_b, i, found->point_b);
        triangle_a[i] = index_of(found->triangle_a);
        triangle_b[i] = index_of(found->triangle_b);
    });
    return nb::make_tuple(array_of(std::move(least), {n}), array_of(std::move(point_a), {n, 3}),
                          array_of(std::move(point_b), {n, 3}), array_of(std::move(triangle_a), {n}),
                          array_of(std::move(triangle_b), {n}));
}

nb::tuple closest_points(const Shape& shape, const Matrices& matrices, const Points& given, double max,
                         std::uint32_t threads) {
    const std::vector<Pose> poses = poses_of(matrices);
    const std::vector<Vec3> points = points_of(given);
    const std::size_t n = items_of({{"points", points.size()}, {"poses", poses.size()}});
    auto least = column(n, any_distance), point = column(n, nowhere, 3);
    auto triangle = column<std::int64_t>(n, -1);
    for_each_item(n, threads, "point", [&](std::size_t i) {
        const auto found = closest_point(shape, of_item(poses, i), of_item(points, i), max);
        if (!found) return;
        least[i] = found->distance;
        put(point, i, found->point);
        triangle[i] = index_of(found->triangle);
    });
    return nb::make_tuple(array_of(std::move(least), {n}), array_of(std::move(point), {n, 3}),
                          array_of(std::move(triangle), {n}));
}

nb::tuple ray_hits(const Shape& shape, const Matrices& matrices, const Points& given_origins,
                   const Points& given_directions, double max, std::uint32_t threads) {
    const std::vector<Pose> poses = poses_of(matrices);
    const std::vector<Vec3> origins = points_of(given_origins), directions = points_of(given_directions);
    const std::size_t n =
        items_of({{"origins", origins.size()}, {"directions", directions.size()}, {"poses", poses.size()}});
    auto length = column(n, any_distance), point = column(n, nowhere, 3), normal = column(n, nowhere, 3);
    auto triangle = column<std::int64_t>(n, -1);
    for_each_item(n, threads, "ray", [&](std::size_t i) {
        const auto hit = raycast(shape, of_item(poses, i), of_item(origins, i), of_item(directions, i), max);
        if (!hit) return;
        length[i] = hit->distance;
        put(point, i, hit->point);
        put(normal, i, hit->normal);
        triangle[i] = index_of(hit->triangle);
    });
    return nb::make_tuple(array_of(std::move(length), {n}), array_of(std::move(point), {n, 3}),
                          array_of(std::move(normal), {n, 3}), array_of(std::move(triangle), {n}));
}

Array rays_meet(const Shape& shape, const Matrices& matrices, const Points& given_origins,
                const Points& given_directions, double max, std::uint32_t threads) {
    const std::vector<Pose> poses = poses_of(matrices);
    const std::vector<Vec3> origins = points_of(given_origins), directions = points_of(given_directions);
    const std::size_t n =
        items_of({{"origins", origins.size()}, {"directions", directions.size()}, {"poses", poses.size()}});
    auto found = column<std::uint8_t>(n, 0);
    for_each_item(n, threads, "ray", [&](std::size_t i) {
        found[i] = raycast_any(shape, of_item(poses, i), of_item(origins, i), of_item(directions, i), max) ? 1 : 0;
    });
    return array_of(std::move(found), {n});
}

Array contains_all(const Shape& shape, const Matrices& matrices, const Points& given, std::uint32_t threads) {
    const std::vector<Pose> poses = poses_of(matrices);
    const std::vector<Vec3> points = points_of(given);
    const std::size_t n = items_of({{"points", points.size()}, {"poses", poses.size()}});
    auto found = column<std::uint8_t>(n, 0);
    for_each_item(n, threads, "point",
                  [&](std::size_t i) { found[i] = contains(shape, of_item(poses, i), of_item(points, i)) ? 1 : 0; });
    return array_of(std::move(found), {n});
}

Array nearest_rigid(const Matrices& matrices) {
    std::vector<Pose> poses = poses_of(matrices);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        try {
            poses[i] = nearest_rigid_pose(poses[i]);
        } catch (const InputError& error) {
            if (poses.size() == 1) throw;
            throw InputError("poses[" + std::to_string(i) + "]: " + error.what());
        }
    }
    return matrices_of(poses);
}

} // namespace

void bind_queries(nb::module_& m) {
    nb::class_<PlacedPairs>(m, "PlacedPairs")
        .def(
            "__init__",
            [](PlacedPairs* self, Shapes a, const Matrices& pose_a, Shapes b, const Matrices& pose_b,
               std::uint32_t threads) {
                const std::size_t count = items_of(
                    {{"a", a.size()}, {"pose_a", pose_a.shape(0)}, {"b", b.size()}, {"pose_b", pose_b.shape(0)}});
                for (const Shapes& shapes : {a, b})
                    for (const auto& shape : shapes)
                        if (!shape) throw InputError("a shape of the list is None");
                new (self) PlacedPairs{std::move(a), std::move(b), poses_of(pose_a), poses_of(pose_b), count, threads};
            },
            "a"_a, "pose_a"_a, "b"_a, "pose_b"_a, "threads"_a)
        .def_ro("count", &PlacedPairs::count);
    m.def("nearest_rigid", &nearest_rigid, "poses"_a);
    m.def("intersects", &intersects_all, "pairs"_a);
    m.def("common_points", &common_points, "pairs"_a);
    m.def("distances", &distances, "pairs"_a, "max"_a);
    m.def("closest_points", &closest_points, "shape"_a, "poses"_a, "points"_a, "max"_a, "threads"_a);
    m.def("ray_hits", &ray_hits, "shape"_a, "poses"_a, "origins"_a, "directions"_a, "max"_a, "threads"_a);
    m.def("rays_meet", &rays_meet, "shape"_a, "poses"_a, "origins"_a, "directions"_a, "max"_a, "threads"_a);
    m.def("contains", &contains_all, "shape"_a, "poses"_a, "points"_a, "threads"_a);
}

} // namespace raycontact::python
