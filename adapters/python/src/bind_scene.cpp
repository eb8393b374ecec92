// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"
#include "batch.h"
#include "bind.h"
#include "columns.h"
#include "contact_bytes.h"
#include "guarded_scene.h"
#include "settings_words.h"
#include "single.h"
#include "without_gil.h"

#include <raycontact/error.h>
#include <raycontact/query.h>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace raycontact::python {

namespace {

std::vector<BodyId> ids_of(const Ids& numbers) {
    std::vector<BodyId> ids;
    ids.reserve(numbers.shape(0));
    for (std::size_t i = 0; i < numbers.shape(0); ++i) ids.push_back(id_of(numbers.data()[i]));
    return ids;
}

/// Throws InputError for one that is not in the scene, before anything is done with the others.
std::vector<BodyId> there(const Scene& scene, const Ids& numbers) {
    std::vector<BodyId> ids = ids_of(numbers);
    for (const BodyId id : ids) scene.pose(id);
    return ids;
}

template <void (Scene::*set)(BodyId, bool)>
void set_flag(GuardedScene& guarded, const Ids& ids, bool value) {
    const auto scene = guarded.enter();
    for (const BodyId id : there(*scene, ids)) ((*scene).*set)(id, value);
}

template <bool (Scene::*is)(BodyId) const>
bool flag(GuardedScene& guarded, std::int64_t id) {
    return ((*guarded.enter()).*is)(id_of(id));
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

/// Columns: bodies, point, normal, depth, sensor.
nb::tuple columns_of(std::span<const Touch> touches) {
    std::vector<std::int64_t> bodies;
    std::vector<double> points;
    std::vector<float> normals, depths;
    AnswerColumn sensors(touches.size());
    for (std::size_t i = 0; i < touches.size(); ++i) {
        const Touch& touch = touches[i];
        bodies.insert(bodies.end(), {number_of(touch.body_a), number_of(touch.body_b)});
        points.insert(points.end(), {touch.point.x, touch.point.y, touch.point.z});
        normals.insert(normals.end(), {touch.normal.x, touch.normal.y, touch.normal.z});
        depths.push_back(touch.depth);
        sensors.set(i, touch.sensor);
    }
    const std::size_t n = touches.size();
    return nb::make_tuple(array_of(std::move(bodies), {n, 2}), array_of(std::move(points), {n, 3}),
                          array_of(std::move(normals), {n, 3}), array_of(std::move(depths), {n}), sensors.take());
}

/// callback: None, or (a, b) -> bool, called on the thread of the step.
void set_pair_filter(GuardedScene& guarded, const nb::object& callback) {
    const auto scene = guarded.enter();
    if (callback.is_none()) return scene->set_pair_filter({});
    // A copy of the filter may be freed without the lock that Python's counts need.
    const std::shared_ptr<nb::object> held(new nb::object(callback), [](nb::object* object) {
        const nb::gil_scoped_acquire gil;
        delete object;
    });
    scene->set_pair_filter([held](BodyId a, BodyId b) {
        const nb::gil_scoped_acquire gil;
        const nb::object answer = (*held)(number_of(a), number_of(b));
        if (answer.is_none()) throw InputError("the pair filter returned None; return whether the two may be a pair");
        return nb::cast<bool>(nb::bool_(answer));
    });
}

nb::tuple save_state(GuardedScene& guarded) {
    const auto scene = guarded.enter();
    std::vector<std::byte> state;
    std::vector<std::shared_ptr<Shape>> shapes;
    {
        const WithoutGil without_gil;
        state = scene->save_state();
        for (const auto& shape : scene->shapes()) shapes.push_back(std::const_pointer_cast<Shape>(shape));
    }
    return nb::make_tuple(nb::bytes(reinterpret_cast<const char*>(state.data()), state.size()), shapes);
}

void load_state(GuardedScene& guarded, const nb::bytes& state, const std::vector<std::shared_ptr<Shape>>& given) {
    const auto scene = guarded.enter();
    const std::vector<std::shared_ptr<const Shape>> shapes(given.begin(), given.end());
    const auto bytes = std::as_bytes(std::span(state.c_str(), state.size()));
    const WithoutGil without_gil;
    scene->load_state(bytes, shapes);
}

/// The bodies that a query counts. No ids given: all.
class Chosen {
public:
    /// Throws InputError for one that is not in the scene.
    Chosen(const Scene& scene, const std::optional<Ids>& ids) {
        if (!ids) return;
        counts_.emplace();
        for (const BodyId id : ids_of(*ids)) {
            scene.pose(id);
            if (id.slot >= counts_->size()) counts_->resize(std::size_t{id.slot} + 1);
            (*counts_)[id.slot] = 1;
        }
    }
    bool has(BodyId id) const { return !counts_ || (id.slot < counts_->size() && (*counts_)[id.slot] != 0); }
    Scene::Wanted wanted() const {
        if (!counts_) return {};
        return [this](BodyId id) { return has(id); };
    }

private:
    std::optional<std::vector<char>> counts_; ///< by slot
};

using Shapes = std::vector<std::shared_ptr<Shape>>;

nb::tuple all_overlaps(GuardedScene& guarded, const Shapes& shapes, const Matrices& matrices,
                       const std::optional<Ids>& ids) {
    const auto scene = guarded.enter();
    const Chosen chosen(*scene, ids);
    const auto poses = poses_of(matrices);
    std::vector<std::vector<BodyId>> found(poses.size());
    for_each_item(poses.size(), scene->settings().execution.threads, "shape", [&](std::size_t i) {
        found[i] = scene->overlaps(*shapes[i % shapes.size()], poses[i], chosen.wanted());
    });
    std::vector<std::int64_t> items, bodies;
    for (std::size_t i = 0; i < found.size(); ++i)
        for (const BodyId id : found[i]) {
            items.push_back(static_cast<std::int64_t>(i));
            bodies.push_back(number_of(id));
        }
    const std::size_t n = items.size();
    return nb::make_tuple(array_of(std::move(items), {n}), array_of(std::move(bodies), {n}));
}

/// Of each `links` poses in a row: whether any of the shapes meets a body.
Array any_overlaps(GuardedScene& guarded, const Shapes& shapes, const Matrices& matrices, std::size_t links,
                   const std::optional<Ids>& ids) {
    const auto scene = guarded.enter();
    const Chosen chosen(*scene, ids);
    const auto poses = poses_of(matrices);
    AnswerColumn found(poses.size() / links);
    for_each_item(poses.size() / links, scene->settings().execution.threads, "configuration", [&](std::size_t i) {
        bool any = false;
        for (std::size_t k = i * links; k < (i + 1) * links && !any; ++k)
            any = scene->overlaps_any(*shapes[k % shapes.size()], poses[k], chosen.wanted());
        found.set(i, any);
    });
    return found.take();
}

/// A moving mesh of each item; what is there once counts for all.
nb::tuple sweep(GuardedScene& guarded, const Shapes& shapes, const Matrices& from, const Matrices& to, double distance,
                const std::optional<Ids>& ids) {
    const auto scene = guarded.enter();
    const Chosen chosen(*scene, ids);
    const auto first = poses_of(from), last = poses_of(to);
    const std::size_t n = items_of({{"shapes", shapes.size()}, {"begin", first.size()}, {"end", last.size()}});
    ImpactColumns impacts(n);
    IndexColumn bodies(n);
    for_each_item(n, scene->settings().execution.threads, "mesh", [&](std::size_t i) {
        const auto met = scene->sweep(*of_item(shapes, i), screw_motion(of_item(first, i), of_item(last, i)), distance,
                                      chosen.wanted());
        if (!met) return;
        impacts.set(i, *met);
        bodies.set(i, number_of(met->body));
    });
    return nb::make_tuple(impacts.take(), bodies.take());
}

nb::tuple sweep_all(GuardedScene& guarded, const Shape& shape, const Matrices& from, const Matrices& to,
                    double distance, const std::optional<Ids>& ids) {
    const auto scene = guarded.enter();
    const Chosen chosen(*scene, ids);
    std::vector<BodyImpact> met;
    {
        const WithoutGil without_gil;
        met = scene->sweep_all(shape, screw_motion(poses_of(from)[0], poses_of(to)[0]), distance, chosen.wanted());
    }
    ImpactColumns impacts(met.size());
    IndexColumn bodies(met.size());
    for (std::size_t i = 0; i < met.size(); ++i) {
        impacts.set(i, met[i]);
        bodies.set(i, number_of(met[i].body));
    }
    return nb::make_tuple(impacts.take(), bodies.take());
}

// As most callers ask, without NumPy's help (bind_single.cpp); no answer: the Python half looks closer.

std::optional<Array> one_overlaps(GuardedScene& guarded, const Shape& shape, nb::handle given) {
    const auto pose = pose_of(given);
    if (!pose) return std::nullopt;
    const auto scene = guarded.enter();
    std::vector<BodyId> ids;
    {
        const WithoutGil without_gil;
        ids = scene->overlaps(shape, *pose);
    }
    return numbers_of(ids);
}

/// poses: (l, 4, 4) of l shapes, (4, 4) of one.
std::optional<bool> one_any_overlaps(GuardedScene& guarded, const std::vector<const Shape*>& shapes, nb::handle given,
                                     bool is_list) {
    std::vector<Pose> poses;
    if (is_list) {
        Matrices matrices;
        if (!nb::try_cast<Matrices>(given, matrices, false) || matrices.shape(0) != shapes.size()) return std::nullopt;
        for (std::size_t i = 0; i < shapes.size(); ++i) {
            const auto pose = rigid_pose(matrices.data() + 16 * i);
            if (!pose) return std::nullopt;
            poses.push_back(*pose);
        }
    } else {
        const auto pose = pose_of(given);
        if (!pose) return std::nullopt;
        poses.push_back(*pose);
    }
    const auto scene = guarded.enter();
    const WithoutGil without_gil;
    for (std::size_t i = 0; i < shapes.size(); ++i)
        if (scene->overlaps_any(*shapes[i], poses[i])) return true;
    return false;
}

bool set_pose(GuardedScene& guarded, std::int64_t id, nb::handle given) {
    const auto pose = pose_of(given);
    if (!pose) return false;
    const auto scene = guarded.enter();
    if (!scene->has(id_of(id))) return false;
    scene->set_pose(id_of(id), *pose);
    return true;
}

nb::tuple distances(GuardedScene& guarded, const Ids& given_a, const Ids& given_b, double max) {
    const auto scene = guarded.enter();
    const auto a = ids_of(given_a), b = ids_of(given_b);
    const std::size_t n = items_of({{"a", a.size()}, {"b", b.size()}});
    DistanceColumns least(n);
    for_each_item(n, scene->settings().execution.threads, "pair", [&](std::size_t i) {
        if (const auto found = scene->distance(of_item(a, i), of_item(b, i), max)) least.set(i, *found);
    });
    return least.take();
}

/// Rays of a query; one of a thing counts for all.
struct Rays {
    std::vector<Vec3> from, along;
    std::size_t count;
    Rays(const Points& origins, const Points& directions)
        : from(points_of(origins)), along(points_of(directions)),
          count(items_of({{"origins", from.size()}, {"directions", along.size()}})) {}
};

nb::tuple raycast(GuardedScene& guarded, const Points& origins, const Points& directions, double max,
                  const std::optional<Ids>& ids) {
    const auto scene = guarded.enter();
    const Chosen chosen(*scene, ids);
    const Rays rays(origins, directions);
    RayHitColumns hits(rays.count);
    IndexColumn bodies(rays.count);
    for_each_item(rays.count, scene->settings().execution.threads, "ray", [&](std::size_t i) {
        const auto hit = scene->raycast(of_item(rays.from, i), of_item(rays.along, i), max, chosen.wanted());
        if (!hit) return;
        hits.set(i, *hit);
        bodies.set(i, number_of(hit->body));
    });
    return nb::make_tuple(hits.take(), bodies.take());
}

/// Of one ray.
nb::tuple raycast_all(GuardedScene& guarded, const Points& origins, const Points& directions, double max,
                      const std::optional<Ids>& ids) {
    const auto scene = guarded.enter();
    const Chosen chosen(*scene, ids);
    const Rays rays(origins, directions);
    const auto found = scene->raycast_all(rays.from[0], rays.along[0], max, chosen.wanted());
    RayHitColumns hits(found.size());
    IndexColumn bodies(found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        hits.set(i, found[i]);
        bodies.set(i, number_of(found[i].body));
    }
    return nb::make_tuple(hits.take(), bodies.take());
}

Array raycast_any(GuardedScene& guarded, const Points& origins, const Points& directions, double max,
                  const std::optional<Ids>& ids) {
    const auto scene = guarded.enter();
    const Chosen chosen(*scene, ids);
    const Rays rays(origins, directions);
    AnswerColumn found(rays.count);
    for_each_item(rays.count, scene->settings().execution.threads, "ray", [&](std::size_t i) {
        found.set(i, scene->raycast_any(of_item(rays.from, i), of_item(rays.along, i), max, chosen.wanted()));
    });
    return found.take();
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
    outputs.reserve(columns.size());
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
        .def("set_pose", &set_pose, "id"_a, "pose"_a.none())
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
                for (const BodyId id : there(*scene, ids)) scene->set_filter(id, groups, mask);
            },
            "ids"_a, "groups"_a, "mask"_a)
        .def("set_static", &set_flag<&Scene::set_static>, "ids"_a, "static"_a)
        .def("is_static", &flag<&Scene::is_static>, "id"_a)
        .def("set_sensor", &set_flag<&Scene::set_sensor>, "ids"_a, "sensor"_a)
        .def("is_sensor", &flag<&Scene::is_sensor>, "id"_a)
        .def("set_pair_filter", &set_pair_filter, "callback"_a.none())
        .def("clear", [](GuardedScene& guarded) { guarded.enter()->clear(); })
        .def("save_state", &save_state)
        .def("load_state", &load_state, "data"_a, "shapes"_a)
        .def("begun", [](GuardedScene& guarded) { return columns_of(guarded.enter()->begun()); })
        .def("ended", [](GuardedScene& guarded) { return columns_of(guarded.enter()->ended()); })
        .def("touching", [](GuardedScene& guarded) { return columns_of(guarded.enter()->touching()); })
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
        .def("raycast", &raycast, "origins"_a, "directions"_a, "max"_a, "wanted"_a.none())
        .def("raycast_all", &raycast_all, "origin"_a, "direction"_a, "max"_a, "wanted"_a.none())
        .def("raycast_any", &raycast_any, "origins"_a, "directions"_a, "max"_a, "wanted"_a.none())
        .def(
            "closest_points",
            [](GuardedScene& guarded, const Points& given, double max, const std::optional<Ids>& ids) {
                const auto scene = guarded.enter();
                const Chosen chosen(*scene, ids);
                const auto places = points_of(given);
                const std::size_t n = places.size();
                ClosestPointColumns nearest(n);
                IndexColumn bodies(n);
                for_each_item(n, scene->settings().execution.threads, "point", [&](std::size_t i) {
                    const auto found = scene->closest_point(places[i], max, chosen.wanted());
                    if (!found) return;
                    nearest.set(i, *found);
                    bodies.set(i, number_of(found->body));
                });
                return nb::make_tuple(nearest.take(), bodies.take());
            },
            "points"_a, "max"_a, "wanted"_a.none())
        .def("sweep", &sweep, "shapes"_a, "begin"_a, "end"_a, "distance"_a, "wanted"_a.none())
        .def("sweep_all", &sweep_all, "shape"_a, "begin"_a, "end"_a, "distance"_a, "wanted"_a.none())
        .def("overlaps", &all_overlaps, "shapes"_a, "poses"_a, "wanted"_a.none())
        .def("overlaps_any", &any_overlaps, "shapes"_a, "poses"_a, "links"_a, "wanted"_a.none())
        .def("one_overlaps", &one_overlaps, "shape"_a, "pose"_a.none())
        .def("one_overlaps_any", &one_any_overlaps, "shapes"_a, "poses"_a.none(), "is_list"_a)
        .def("distances", &distances, "a"_a, "b"_a, "max"_a);
}

} // namespace raycontact::python
