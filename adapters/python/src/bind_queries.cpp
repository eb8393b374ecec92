// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"
#include "batch.h"
#include "bind.h"
#include "columns.h"
#include "contact_bytes.h"
#include "settings_words.h"
#include "without_gil.h"

#include <raycontact/error.h>
#include <raycontact/query.h>
#include <raycontact/scene.h>
#include <raycontact/separation.h>

#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <span>

namespace raycontact::python {

namespace {

using Shapes = std::vector<std::shared_ptr<Shape>>;

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

Array intersects_all(const PlacedPairs& pairs) {
    AnswerColumn found(pairs.count);
    pairs.for_each([&](std::size_t i, const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
        found.set(i, intersects(a, pose_a, b, pose_b));
    });
    return found.take();
}

Array common_points(const PlacedPairs& pairs) {
    VectorColumn points(pairs.count);
    pairs.for_each([&](std::size_t i, const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
        if (const auto point = common_point(a, pose_a, b, pose_b)) points.set(i, *point);
    });
    return points.take();
}

nb::tuple distances(const PlacedPairs& pairs, double max) {
    DistanceColumns least(pairs.count);
    pairs.for_each([&](std::size_t i, const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
        if (const auto found = distance(a, pose_a, b, pose_b, max)) least.set(i, *found);
    });
    return least.take();
}

nb::tuple separations(const PlacedPairs& pairs) {
    LengthColumn distance(pairs.count);
    VectorColumn normal(pairs.count), point_a(pairs.count), point_b(pairs.count);
    pairs.for_each([&](std::size_t i, const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
        const Separation found = separation(a, pose_a, b, pose_b);
        distance.set(i, found.distance);
        normal.set(i, found.normal);
        point_a.set(i, found.point_a);
        point_b.set(i, found.point_b);
    });
    return nb::make_tuple(distance.take(), normal.take(), point_a.take(), point_b.take());
}

nb::tuple all_contact_patches(const PlacedPairs& pairs) {
    std::vector<std::vector<ContactPatch>> found(pairs.count);
    pairs.for_each([&](std::size_t i, const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
        found[i] = contact_patches(a, pose_a, b, pose_b);
    });
    std::size_t n = 0, at = 0;
    for (const std::vector<ContactPatch>& patches : found) n += patches.size();
    IndexColumn pair(n);
    LengthColumn area(n), volume(n), depth(n);
    VectorColumn centre(n), normal(n);
    std::vector<double> corners;
    std::vector<std::int64_t> first_corner{0};
    for (std::size_t i = 0; i < found.size(); ++i)
        for (const ContactPatch& patch : found[i]) {
            for (const Vec3& corner : patch.hull) corners.insert(corners.end(), {corner.x, corner.y, corner.z});
            first_corner.push_back(static_cast<std::int64_t>(corners.size() / 3));
            pair.set(at, static_cast<std::int64_t>(i));
            area.set(at, patch.area);
            volume.set(at, patch.volume);
            depth.set(at, patch.depth);
            centre.set(at, patch.centre);
            normal.set(at++, patch.normal);
        }
    const std::size_t count = corners.size() / 3;
    return nb::make_tuple(pair.take(), area.take(), volume.take(), depth.take(), centre.take(), normal.take(),
                          array_of(std::move(corners), {count, 3}), array_of(std::move(first_corner), {n + 1}));
}

/// Each pair's bodies are 2 i and 2 i + 1 of one scene that lives for the call. Pairs go in blocks, with their bodies,
/// between which Ctrl-C counts.
ReadOnlyArray collide(const PlacedPairs& pairs, const nb::dict& words) {
    Settings settings = settings_from(words, {});
    settings.execution.threads = pairs.threads;
    auto found = std::make_shared<std::vector<Contact>>();
    {
        WithoutGil without_gil;
        Scene scene(settings);
        std::vector<Pair> bodies;
        constexpr std::size_t block = 4096;
        for (std::size_t begin = 0; begin < pairs.count && !is_ending(); begin += block) {
            bodies.clear();
            for (std::size_t i = begin; i < std::min(begin + block, pairs.count); ++i) {
                const BodyId a = scene.add(of_item(pairs.a, i), of_item(pairs.pose_a, i));
                bodies.emplace_back(a, scene.add(of_item(pairs.b, i), of_item(pairs.pose_b, i)));
            }
            const auto contacts = scene.find_contacts(bodies);
            found->insert(found->end(), contacts.begin(), contacts.end());
            without_gil.check_signals();
        }
    }
    return bytes_of(std::move(found));
}

/// Paths of as many poses each, one after the other; what is there once counts for all.
class Paths {
public:
    Paths(const Matrices& matrices, std::size_t steps) : poses_(poses_of(matrices)), steps_(steps) {}
    std::size_t count() const { return poses_.size() / steps_; }
    std::span<const Pose> operator[](std::size_t i) const {
        return std::span(poses_).subspan(count() == 1 ? 0 : i * steps_, steps_);
    }

private:
    std::vector<Pose> poses_;
    std::size_t steps_;
};

/// Two lists of moving shapes.
struct MovingPairs {
    const Shapes &a, &b;
    Paths path_a, path_b;
    std::size_t count;
    std::uint32_t threads;

    MovingPairs(const Shapes& first, const Matrices& poses_a, std::size_t steps_a, const Shapes& second,
                const Matrices& poses_b, std::size_t steps_b, std::uint32_t with_threads)
        : a(first), b(second), path_a(poses_a, steps_a), path_b(poses_b, steps_b),
          count(items_of({{"a", a.size()}, {"path_a", path_a.count()}, {"b", b.size()}, {"path_b", path_b.count()}})),
          threads(with_threads) {}

    template <typename Ask>
    void for_each(const Ask& ask) const {
        for_each_item(count, threads, "pair",
                      [&](std::size_t i) { ask(i, *of_item(a, i), path_a[i], *of_item(b, i), path_b[i]); });
    }
};
using Path = std::span<const Pose>;

nb::tuple times_of_impact(const Shapes& a, const Matrices& poses_a, std::size_t steps_a, const Shapes& b,
                          const Matrices& poses_b, std::size_t steps_b, double distance, double tolerance,
                          std::uint32_t threads) {
    const MovingPairs pairs(a, poses_a, steps_a, b, poses_b, steps_b, threads);
    ImpactColumns first(pairs.count);
    pairs.for_each([&](std::size_t i, const Shape& one, Path path, const Shape& other, Path others) {
        if (const auto found = time_of_impact(one, path, other, others, distance, tolerance)) first.set(i, *found);
    });
    return first.take();
}

nb::tuple path_clearances(const Shapes& a, const Matrices& poses_a, std::size_t steps_a, const Shapes& b,
                          const Matrices& poses_b, std::size_t steps_b, double max, double tolerance,
                          std::uint32_t threads) {
    const MovingPairs pairs(a, poses_a, steps_a, b, poses_b, steps_b, threads);
    DistanceColumns least(pairs.count);
    LengthColumn time(pairs.count);
    AnswerColumn meet(pairs.count);
    pairs.for_each([&](std::size_t i, const Shape& one, Path path, const Shape& other, Path others) {
        const auto found = path_clearance(one, path, other, others, max, tolerance);
        if (!found) return;
        least.set(i, *found);
        time.set(i, found->time);
        meet.set(i, found->meet);
    });
    return nb::make_tuple(least.distance.take(), least.point_a.take(), least.point_b.take(), least.triangle_a.take(),
                          least.triangle_b.take(), time.take(), meet.take());
}

nb::tuple closest_points(const Shape& shape, const Matrices& matrices, const Points& given, double max,
                         std::uint32_t threads) {
    const std::vector<Pose> poses = poses_of(matrices);
    const std::vector<Vec3> points = points_of(given);
    const std::size_t n = items_of({{"points", points.size()}, {"poses", poses.size()}});
    ClosestPointColumns nearest(n);
    for_each_item(n, threads, "point", [&](std::size_t i) {
        if (const auto found = closest_point(shape, of_item(poses, i), of_item(points, i), max)) nearest.set(i, *found);
    });
    return nearest.take();
}

nb::tuple signed_distances(const Shape& shape, const Matrices& matrices, const Points& given, std::uint32_t threads) {
    const std::vector<Pose> poses = poses_of(matrices);
    const std::vector<Vec3> points = points_of(given);
    const std::size_t n = items_of({{"points", points.size()}, {"poses", poses.size()}});
    LengthColumn distance(n);
    VectorColumn point(n), gradient(n);
    IndexColumn triangle(n);
    const auto set = [&](std::size_t i, const SignedDistance& found) {
        distance.set(i, found.distance);
        point.set(i, found.point);
        gradient.set(i, found.gradient);
        triangle.set_triangle(i, found.triangle);
    };
    if (poses.size() == 1 && points.size() == n) { // neighbours share work
        WithoutGil without_gil;
        constexpr std::size_t block = 1 << 18;
        for (std::size_t begin = 0; begin < n && !is_ending(); begin += block) {
            const auto part = std::span(points).subspan(begin, std::min(block, n - begin));
            const std::vector<SignedDistance> found = signed_distance(shape, poses[0], part, threads);
            for (std::size_t i = 0; i < found.size(); ++i) set(begin + i, found[i]);
            without_gil.check_signals();
        }
    } else {
        for_each_item(n, threads, "point", [&](std::size_t i) {
            set(i, signed_distance(shape, of_item(poses, i), std::span(&of_item(points, i), 1), 1)[0]);
        });
    }
    return nb::make_tuple(distance.take(), point.take(), triangle.take(), gradient.take());
}

/// Rays at a shape; what is there once counts for all.
struct Rays {
    std::vector<Pose> poses;
    std::vector<Vec3> origins, directions;
    std::size_t count;

    Rays(const Matrices& matrices, const Points& from, const Points& along)
        : poses(poses_of(matrices)), origins(points_of(from)), directions(points_of(along)),
          count(items_of({{"origins", origins.size()}, {"directions", directions.size()}, {"poses", poses.size()}})) {}
};

nb::tuple ray_hits(const Shape& shape, const Matrices& matrices, const Points& origins, const Points& directions,
                   double max, std::uint32_t threads) {
    const Rays rays(matrices, origins, directions);
    RayHitColumns hits(rays.count);
    for_each_item(rays.count, threads, "ray", [&](std::size_t i) {
        const auto hit =
            raycast(shape, of_item(rays.poses, i), of_item(rays.origins, i), of_item(rays.directions, i), max);
        if (hit) hits.set(i, *hit);
    });
    return hits.take();
}

Array rays_meet(const Shape& shape, const Matrices& matrices, const Points& origins, const Points& directions,
                double max, std::uint32_t threads) {
    const Rays rays(matrices, origins, directions);
    AnswerColumn found(rays.count);
    for_each_item(rays.count, threads, "ray", [&](std::size_t i) {
        found.set(
            i, raycast_any(shape, of_item(rays.poses, i), of_item(rays.origins, i), of_item(rays.directions, i), max));
    });
    return found.take();
}

Array contains_all(const Shape& shape, const Matrices& matrices, const Points& given, std::uint32_t threads) {
    const std::vector<Pose> poses = poses_of(matrices);
    const std::vector<Vec3> points = points_of(given);
    const std::size_t n = items_of({{"points", points.size()}, {"poses", poses.size()}});
    AnswerColumn found(n);
    for_each_item(n, threads, "point",
                  [&](std::size_t i) { found.set(i, contains(shape, of_item(poses, i), of_item(points, i))); });
    return found.take();
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
    m.attr("contact_size") = sizeof(Contact);
    m.def("contact_layout", &contact_layout);
    m.def("collide", &collide, "pairs"_a, "settings"_a);
    m.def("intersects", &intersects_all, "pairs"_a);
    m.def("common_points", &common_points, "pairs"_a);
    m.def("distances", &distances, "pairs"_a, "max"_a);
    m.def("separations", &separations, "pairs"_a);
    m.def("contact_patches", &all_contact_patches, "pairs"_a);
    m.def("times_of_impact", &times_of_impact, "a"_a, "poses_a"_a, "steps_a"_a, "b"_a, "poses_b"_a, "steps_b"_a,
          "distance"_a, "tolerance"_a, "threads"_a);
    m.def("path_clearances", &path_clearances, "a"_a, "poses_a"_a, "steps_a"_a, "b"_a, "poses_b"_a, "steps_b"_a,
          "max"_a, "tolerance"_a, "threads"_a);
    m.def("closest_points", &closest_points, "shape"_a, "poses"_a, "points"_a, "max"_a, "threads"_a);
    m.def("signed_distances", &signed_distances, "shape"_a, "poses"_a, "points"_a, "threads"_a);
    m.def("ray_hits", &ray_hits, "shape"_a, "poses"_a, "origins"_a, "directions"_a, "max"_a, "threads"_a);
    m.def("rays_meet", &rays_meet, "shape"_a, "poses"_a, "origins"_a, "directions"_a, "max"_a, "threads"_a);
    m.def("contains", &contains_all, "shape"_a, "poses"_a, "points"_a, "threads"_a);
}

} // namespace raycontact::python
