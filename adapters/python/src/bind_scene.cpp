// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"
#include "batch.h"
#include "bind.h"
#include "columns.h"
#include "contact_bytes.h"
#include "guarded_scene.h"
#include "settings_words.h"
#include "without_gil.h"

#include <raycontact/error.h>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <tuple>

namespace raycontact::python {

namespace {

std::vector<BodyId> ids_of(const Ids& numbers) {
    std::vector<BodyId> ids;
    ids.reserve(numbers.shape(0));
    for (std::size_t i = 0; i < numbers.shape(0); ++i) ids.push_back(id_of(numbers.data()[i]));
    return ids;
}

Array numbers_of(std::span<const BodyId> ids) {
    std::vector<std::int64_t> numbers;
    numbers.reserve(ids.size());
    for (const BodyId id : ids) numbers.push_back(number_of(id));
    return array_of(std::move(numbers), {ids.size()});
}

std::vector<Pair> pairs_of(const Pairs& numbers) {
    std::vector<Pair> pairs;
    pairs.reserve(numbers.shape(0));
    for (std::size_t i = 0; i < numbers.shape(0); ++i)
        pairs.emplace_back(id_of(numbers.data()[2 * i]), id_of(numbers.data()[2 * i + 1]));
    return pairs;
}

void set_poses(GuardedScene& guarded, const Ids& ids, const Matrices& matrices) {
    const auto scene = guarded.enter();
    scene->set_poses(ids_of(ids), poses_of(matrices));
}

/// shapes: one for all poses, or one for each; added as a whole or not at all.
Array add(GuardedScene& guarded, const std::vector<std::shared_ptr<Shape>>& shapes, const Matrices& matrices) {
    const auto scene = guarded.enter();
    const std::size_t count = matrices.shape(0);
    if (shapes.size() != 1 && shapes.size() != count)
        throw InputError("Scene.add: " + std::to_string(shapes.size()) + " shapes for " + std::to_string(count)
                         + " poses; give as many, or one shape");
    // First, so that a list with a fault uses up no ids.
    const std::vector<Pose> poses = poses_of(matrices);
    for (std::size_t i = 0; i < count; ++i)
        check_pose(poses[i], ("Scene.add: poses[" + std::to_string(i) + "]").c_str());
    for (const auto& shape : shapes)
        if (!shape) throw InputError("Scene.add: a shape of the list is None");
    std::vector<BodyId> ids;
    ids.reserve(count);
    try {
        for (std::size_t i = 0; i < count; ++i) ids.push_back(scene->add(of_item(shapes, i), poses[i]));
    } catch (...) {
        for (const BodyId id : ids) scene->remove(id);
        throw;
    }
    return numbers_of(ids);
}

ReadOnlyArray find_contacts(GuardedScene& guarded, const std::optional<Pairs>& given) {
    const auto scene = guarded.enter();
    if (given) {
        const std::vector<Pair> pairs = pairs_of(*given);
        WithoutGil without_gil;
        scene->find_contacts(pairs);
        without_gil.check_signals();
    } else {
        WithoutGil without_gil;
        scene->find_contacts();
        without_gil.check_signals();
    }
    return bytes_of(scene->shared_contacts());
}

nb::tuple lost_contacts(GuardedScene& guarded) {
    const auto scene = guarded.enter();
    const auto lost = scene->lost_contacts();
    std::vector<std::int64_t> bodies;
    std::vector<std::uint64_t> keys;
    for (const LostContact& contact : lost) {
        bodies.insert(bodies.end(), {number_of(contact.body_a), number_of(contact.body_b)});
        keys.push_back(contact.key());
    }
    return nb::make_tuple(array_of(std::move(bodies), {lost.size(), 2}), array_of(std::move(keys), {lost.size()}));
}

UserMemory memory_at(bool is_cuda, std::uint64_t address, std::size_t bytes, std::uint64_t stream) {
    if (is_cuda) return UserMemory::cuda(address, bytes, reinterpret_cast<void*>(stream));
    return UserMemory::host({reinterpret_cast<std::byte*>(address), bytes});
}

/// Name, whether on a CUDA device, address, bytes, stream, whether points are in float32.
using Column = std::tuple<std::string, bool, std::uint64_t, std::size_t, std::uint64_t, bool>;

std::size_t write_contacts(GuardedScene& guarded, const std::vector<Column>& columns) {
    const auto scene = guarded.enter();
    const WithoutGil without_gil;
    std::vector<ContactOutput> outputs;
    for (const auto& [name, is_cuda, address, bytes, stream, single] : columns)
        outputs.push_back({contact_column_from(name), memory_at(is_cuda, address, bytes, stream),
                           single ? NumberType::float32 : NumberType::float64});
    return scene->write_contacts(outputs);
}

Array pairs_array(std::span<const Pair> pairs) {
    std::vector<std::int64_t> numbers;
    numbers.reserve(2 * pairs.size());
    for (const auto& [a, b] : pairs) numbers.insert(numbers.end(), {number_of(a), number_of(b)});
    return array_of(std::move(numbers), {pairs.size(), 2});
}

} // namespace

void bind_scene(nb::module_& m) {
    m.def(
        "copy_from_cuda",
        [](std::uint64_t address, std::uint64_t stream, std::uint64_t to, std::size_t bytes) {
            const WithoutGil without_gil;
            memory_at(true, address, bytes, stream).read({reinterpret_cast<std::byte*>(to), bytes});
        },
        "address"_a, "stream"_a, "to"_a, "bytes"_a);
    nb::class_<GuardedScene>(m, "Scene")
        .def(
            "__init__",
            [](GuardedScene* self, const nb::dict& words) {
                const Settings settings = settings_from(words, {});
                const WithoutGil without_gil; // a driver may take a while to open
                new (self) GuardedScene(settings);
            },
            "settings"_a)
        .def("add", &add, "shapes"_a, "poses"_a)
        .def(
            "remove",
            [](GuardedScene& guarded, const Ids& ids) {
                const auto scene = guarded.enter();
                for (const BodyId id : ids_of(ids)) scene->remove(id);
            },
            "ids"_a)
        .def("set_poses", &set_poses, "ids"_a, "poses"_a)
        .def("write_contacts", &write_contacts, "columns"_a)
        .def(
            "poses",
            [](GuardedScene& guarded, const Ids& ids) {
                const auto scene = guarded.enter();
                std::vector<Pose> poses;
                for (const BodyId id : ids_of(ids)) poses.push_back(scene->pose(id));
                return matrices_of(poses);
            },
            "ids"_a)
        .def(
            "set_next_poses",
            [](GuardedScene& guarded, const Ids& ids, const Matrices& matrices) {
                const auto scene = guarded.enter();
                const std::vector<BodyId> bodies = ids_of(ids);
                if (bodies.size() != matrices.shape(0))
                    throw InputError("Scene.set_next_poses: " + std::to_string(matrices.shape(0)) + " poses for "
                                     + std::to_string(bodies.size()) + " bodies; give one for each");
                for (std::size_t i = 0; i < bodies.size(); ++i) scene->set_next_pose(bodies[i], pose_at(matrices, i));
            },
            "ids"_a, "poses"_a)
        .def(
            "set_speculative_margin",
            [](GuardedScene& guarded, std::int64_t id, std::optional<double> margin) {
                guarded.enter()->set_speculative_margin(id_of(id), margin);
            },
            "id"_a, "margin"_a.none())
        .def(
            "set_filter",
            [](GuardedScene& guarded, const Ids& ids, std::uint32_t groups, std::uint32_t mask) {
                const auto scene = guarded.enter();
                for (const BodyId id : ids_of(ids)) scene->set_filter(id, groups, mask);
            },
            "ids"_a, "groups"_a, "mask"_a)
        .def(
            "shape",
            [](GuardedScene& guarded, std::int64_t id) {
                return std::const_pointer_cast<Shape>(guarded.enter()->shape(id_of(id)).shared_from_this());
            },
            "id"_a)
        .def(
            "has", [](GuardedScene& guarded, std::int64_t id) { return guarded.enter()->has(id_of(id)); }, "id"_a)
        .def_prop_ro(
            "ids", [](GuardedScene& guarded) { return numbers_of(guarded.enter()->bodies()); },
            nb::rv_policy::automatic)
        .def(
            "set_settings",
            [](GuardedScene& guarded, const nb::dict& words) {
                const auto scene = guarded.enter();
                scene->set_settings(settings_from(words, scene->settings()));
            },
            "settings"_a)
        .def_prop_ro("settings", [](GuardedScene& guarded) { return words_of(guarded.enter()->settings()); })
        .def("prepare",
             [](GuardedScene& guarded) {
                 const auto scene = guarded.enter();
                 const WithoutGil without_gil;
                 scene->prepare();
             })
        .def("find_contacts", &find_contacts, "pairs"_a.none())
        .def_prop_ro(
            "contacts", [](GuardedScene& guarded) { return bytes_of(guarded.enter()->shared_contacts()); },
            nb::rv_policy::automatic)
        .def("lost_contacts", &lost_contacts)
        .def_prop_ro("device_choice", [](GuardedScene& guarded) { return guarded.enter()->device_choice(); })
        .def_prop_ro("stats", [](GuardedScene& guarded) { return guarded.enter()->stats(); })
        .def_prop_ro(
            "pairs", [](GuardedScene& guarded) { return pairs_array(guarded.enter()->pairs()); },
            nb::rv_policy::automatic)
        .def(
            "raycast",
            [](GuardedScene& guarded, const Points& origins, const Points& directions, double max) {
                const auto scene = guarded.enter();
                const std::size_t n = origins.shape(0);
                if (directions.shape(0) != n)
                    throw InputError("Scene.raycast: " + std::to_string(directions.shape(0)) + " directions for "
                                     + std::to_string(n) + " origins; give one for each");
                const auto from = points_of(origins), along = points_of(directions);
                RayHitColumns hits(n);
                IndexColumn bodies(n);
                for_each_item(n, scene->settings().execution.threads, "ray", [&](std::size_t i) {
                    const auto hit = scene->raycast(from[i], along[i], max);
                    if (!hit) return;
                    hits.set(i, *hit);
                    bodies.set(i, number_of(hit->body));
                });
                return nb::make_tuple(hits.take(), bodies.take());
            },
            "origins"_a, "directions"_a, "max"_a)
        .def(
            "closest_points",
            [](GuardedScene& guarded, const Points& given, double max) {
                const auto scene = guarded.enter();
                const auto places = points_of(given);
                const std::size_t n = places.size();
                ClosestPointColumns nearest(n);
                IndexColumn bodies(n);
                for_each_item(n, scene->settings().execution.threads, "point", [&](std::size_t i) {
                    const auto found = scene->closest_point(places[i], max);
                    if (!found) return;
                    nearest.set(i, *found);
                    bodies.set(i, number_of(found->body));
                });
                return nb::make_tuple(nearest.take(), bodies.take());
            },
            "points"_a, "max"_a)
        .def(
            "overlaps",
            [](GuardedScene& guarded, const Shape& shape, const Matrices& matrices) {
                const auto scene = guarded.enter();
                const Pose pose = pose_at(matrices, 0);
                std::vector<BodyId> ids;
                {
                    const WithoutGil without_gil;
                    ids = scene->overlaps(shape, pose);
                }
                return numbers_of(ids);
            },
            "shape"_a, "pose"_a);
}

} // namespace raycontact::python
