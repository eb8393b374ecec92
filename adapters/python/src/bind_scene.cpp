// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"
#include "batch.h"
#include "bind.h"
#include "guarded_scene.h"

#include <raycontact/error.h>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstddef>

namespace raycontact::python {

namespace {

/// The list of contacts as bytes, which raycontact/contacts.py reads by contact_layout(). The array keeps the list.
Array bytes_of(std::shared_ptr<const std::vector<Contact>> contacts) {
    using Held = std::shared_ptr<const std::vector<Contact>>;
    const auto* first = reinterpret_cast<const std::uint8_t*>(contacts->data());
    const std::size_t size = contacts->size() * sizeof(Contact);
    auto held = std::make_unique<Held>(std::move(contacts));
    const nb::capsule owner(held.release(), [](void* given) noexcept { delete static_cast<Held*>(given); });
    // No later step writes here, so the array may be written, as what takes arrays by DLPack wants it.
    return Array(const_cast<std::uint8_t*>(first), {size}, owner, {}, nb::dtype<std::uint8_t>());
}

/// Name, NumPy type, length (0: a number), offset.
nb::list contact_layout() {
    nb::list fields;
    const auto field = [&](const char* name, const char* type, int length, std::size_t offset) {
        fields.append(nb::make_tuple(name, type, length, offset));
    };
    constexpr std::size_t feature = offsetof(Contact, feature);
    static_assert(sizeof(BodyId) == 8 && offsetof(Contact, body_b) == offsetof(Contact, body_a) + 8);
    static_assert(offsetof(ContactFeature, index_b) == offsetof(ContactFeature, index_a) + 4);
    field("bodies", "<i8", 2, offsetof(Contact, body_a));
    field("kind", "u1", 0, feature + offsetof(ContactFeature, kind));
    field("source", "u1", 0, feature + offsetof(ContactFeature, source));
    field("indices", "<u4", 2, feature + offsetof(ContactFeature, index_a));
    field("is_new", "?", 0, offsetof(Contact, is_new));
    field("normal", "<f4", 3, offsetof(Contact, normal));
    field("depth", "<f4", 0, offsetof(Contact, depth));
    field("ray_length", "<f4", 0, offsetof(Contact, ray_length));
    field("weight", "<f4", 0, offsetof(Contact, weight));
    field("point_a", "<f8", 3, offsetof(Contact, point_a));
    field("point_b", "<f8", 3, offsetof(Contact, point_b));
    return fields;
}

/// None: `key` keeps its value.
template <typename Value>
void set_if(const nb::dict& words, const char* key, Value& value) {
    if (words.contains(key)) value = nb::cast<Value>(words[key]);
}
template <typename Value>
void set_word(const nb::dict& words, const char* key, Value& value, Value (*from)(std::string_view)) {
    if (words.contains(key)) value = from(nb::cast<std::string>(words[key]));
}

/// raycontact/scene.py names all words; another one is a TypeError there.
Settings settings_from(const nb::dict& words, Settings s) {
    set_word(words, "method", s.method, &method_from);
    set_word(words, "direction", s.direction, &direction_from);
    set_word(words, "features", s.features, &features_from);
    set_if(words, "speculative", s.speculative);
    set_if(words, "speculative_margin", s.speculative_margin);
    set_if(words, "max_contacts_per_pair", s.max_contacts_per_pair);
    set_if(words, "max_contacts", s.max_contacts);
    set_if(words, "devices", s.execution.devices);
    set_if(words, "threads", s.execution.threads);
    set_word(words, "schedule", s.execution.schedule, &schedule_from);
    set_if(words, "inexact", s.execution.inexact);
    set_word(words, "caster", s.paper.caster, &caster_from);
    set_if(words, "displacement_threshold", s.paper.displacement_threshold);
    set_if(words, "confidence", s.paper.confidence);
    set_if(words, "culling_distance", s.paper.culling_distance);
    set_if(words, "distance_extension", s.paper.distance_extension);
    set_if(words, "max_iterations", s.paper.max_iterations);
    set_if(words, "cast_lost_walks", s.paper.cast_lost_walks);
    set_if(words, "skip_outside", s.paper.skip_outside);
    return s;
}

std::string word(std::string_view text) {
    return std::string(text);
}

nb::dict words_of(const Settings& s) {
    nb::dict words;
    words["method"] = word(to_string(s.method));
    words["direction"] = word(to_string(s.direction));
    words["features"] = word(to_string(s.features));
    words["speculative"] = s.is_speculative();
    words["speculative_margin"] = s.speculative_margin;
    words["max_contacts_per_pair"] = s.max_contacts_per_pair;
    words["max_contacts"] = s.max_contacts;
    words["devices"] = s.execution.devices;
    words["threads"] = s.execution.threads;
    words["schedule"] = word(to_string(s.execution.schedule));
    words["inexact"] = s.execution.inexact;
    words["caster"] = word(to_string(s.paper.caster));
    words["displacement_threshold"] = s.paper.displacement_threshold;
    words["confidence"] = s.paper.confidence;
    words["culling_distance"] = s.paper.culling_distance;
    words["distance_extension"] = s.paper.distance_extension;
    words["max_iterations"] = s.paper.max_iterations;
    words["cast_lost_walks"] = s.paper.cast_lost_walks;
    words["skip_outside"] = s.paper.skip_outside;
    return words;
}

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
    std::vector<BodyId> ids;
    ids.reserve(count);
    try {
        for (std::size_t i = 0; i < count; ++i)
            ids.push_back(scene->add(shapes[shapes.size() == 1 ? 0 : i], pose_at(matrices, i)));
    } catch (...) {
        for (const BodyId id : ids) scene->remove(id);
        throw;
    }
    return numbers_of(ids);
}

Array find_contacts(GuardedScene& guarded, const std::optional<Pairs>& given) {
    const auto scene = guarded.enter();
    if (given) {
        const std::vector<Pair> pairs = pairs_of(*given);
        const nb::gil_scoped_release without_gil;
        scene->find_contacts(pairs);
    } else {
        const nb::gil_scoped_release without_gil;
        scene->find_contacts();
    }
    check_signals();
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

Array pairs_array(std::span<const Pair> pairs) {
    std::vector<std::int64_t> numbers;
    numbers.reserve(2 * pairs.size());
    for (const auto& [a, b] : pairs) numbers.insert(numbers.end(), {number_of(a), number_of(b)});
    return array_of(std::move(numbers), {pairs.size(), 2});
}

/// Contacts of many pairs of placed shapes: each pair's bodies are 2 i and 2 i + 1 of one scene that lives for the
/// call. Pairs go in blocks, between which Ctrl-C counts.
Array collide(const std::vector<std::shared_ptr<Shape>>& a, const Matrices& pose_a,
              const std::vector<std::shared_ptr<Shape>>& b, const Matrices& pose_b, std::size_t count,
              const nb::dict& words) {
    Settings settings = settings_from(words, {});
    auto found = std::make_shared<std::vector<Contact>>();
    {
        const nb::gil_scoped_release without_gil;
        Scene scene(settings);
        std::vector<Pair> pairs;
        pairs.reserve(count);
        const auto place = [&](const auto& shapes, const Matrices& matrices, std::size_t i) {
            try {
                return scene.add(shapes[shapes.size() == 1 ? 0 : i], pose_at(matrices, matrices.shape(0) == 1 ? 0 : i));
            } catch (const InputError& error) {
                if (count == 1) throw;
                throw InputError("pair " + std::to_string(i) + ": " + error.what());
            }
        };
        for (std::size_t i = 0; i < count; ++i) {
            const BodyId first = place(a, pose_a, i);
            pairs.emplace_back(first, place(b, pose_b, i));
        }
        constexpr std::size_t block = 4096;
        for (std::size_t begin = 0; begin < count; begin += block) {
            const auto contacts = scene.find_contacts(std::span(pairs).subspan(begin, std::min(block, count - begin)));
            found->insert(found->end(), contacts.begin(), contacts.end());
            check_signals();
        }
    }
    return bytes_of(std::move(found));
}

} // namespace

void bind_scene(nb::module_& m) {
    m.attr("contact_size") = sizeof(Contact);
    m.def("contact_layout", &contact_layout);
    m.def("collide", &collide, "a"_a, "pose_a"_a, "b"_a, "pose_b"_a, "count"_a, "settings"_a);
    nb::class_<GuardedScene>(m, "Scene")
        .def(
            "__init__",
            [](GuardedScene* self, const nb::dict& words) {
                const Settings settings = settings_from(words, {});
                const nb::gil_scoped_release without_gil; // a driver may take a while to open
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
                 const nb::gil_scoped_release without_gil;
                 scene->prepare();
             })
        .def("find_contacts", &find_contacts, "pairs"_a.none())
        .def_prop_ro(
            "contacts", [](GuardedScene& guarded) { return bytes_of(guarded.enter()->shared_contacts()); },
            nb::rv_policy::automatic)
        .def("lost_contacts", &lost_contacts)
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
                const double nan = std::numeric_limits<double>::quiet_NaN();
                std::vector<double> length(n, any_distance), points(3 * n, nan), normals(3 * n, nan);
                std::vector<std::int64_t> triangles(n, -1), bodies(n, -1);
                for_each_item(n, scene->settings().execution.threads, "ray", [&](std::size_t i) {
                    const auto hit = scene->raycast(from[i], along[i], max);
                    if (!hit) return;
                    length[i] = hit->distance;
                    std::ranges::copy(std::array{hit->point.x, hit->point.y, hit->point.z}, &points[3 * i]);
                    std::ranges::copy(std::array{hit->normal.x, hit->normal.y, hit->normal.z}, &normals[3 * i]);
                    triangles[i] = hit->triangle;
                    bodies[i] = number_of(hit->body);
                });
                return nb::make_tuple(array_of(std::move(length), {n}), array_of(std::move(points), {n, 3}),
                                      array_of(std::move(normals), {n, 3}), array_of(std::move(triangles), {n}),
                                      array_of(std::move(bodies), {n}));
            },
            "origins"_a, "directions"_a, "max"_a)
        .def(
            "closest_points",
            [](GuardedScene& guarded, const Points& given, double max) {
                const auto scene = guarded.enter();
                const auto places = points_of(given);
                const std::size_t n = places.size();
                std::vector<double> least(n, any_distance), points(3 * n, std::numeric_limits<double>::quiet_NaN());
                std::vector<std::int64_t> triangles(n, -1), bodies(n, -1);
                for_each_item(n, scene->settings().execution.threads, "point", [&](std::size_t i) {
                    const auto found = scene->closest_point(places[i], max);
                    if (!found) return;
                    least[i] = found->distance;
                    std::ranges::copy(std::array{found->point.x, found->point.y, found->point.z}, &points[3 * i]);
                    triangles[i] = found->triangle;
                    bodies[i] = number_of(found->body);
                });
                return nb::make_tuple(array_of(std::move(least), {n}), array_of(std::move(points), {n, 3}),
                                      array_of(std::move(triangles), {n}), array_of(std::move(bodies), {n}));
            },
            "points"_a, "max"_a)
        .def(
            "overlaps",
            [](GuardedScene& guarded, const Shape& shape, const Matrices& matrices) {
                const auto scene = guarded.enter();
                const Pose pose = pose_at(matrices, 0);
                std::vector<BodyId> ids;
                {
                    const nb::gil_scoped_release without_gil;
                    ids = scene->overlaps(shape, pose);
                }
                return numbers_of(ids);
            },
            "shape"_a, "pose"_a);
}

} // namespace raycontact::python
