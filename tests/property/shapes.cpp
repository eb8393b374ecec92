// SPDX-License-Identifier: Apache-2.0
#include "property/shapes.h"

#include "reference/meshes.h"
#include "reference/vector.h"

#include "prepared_shape.h"
#include "scenes/models/model.h"

#include <algorithm>
#include <bit>
#include <map>

namespace raycontact::reference {

Subject::Subject(const Mesh& mesh) : shape(prepared_shape(mesh)), solid(make_solid(*shape)) {}

Mesh model_mesh(const char* kind) {
    Mesh mesh = scenes::scene_model(kind, 902).mesh;
    mesh.name = kind;
    return mesh;
}

const std::vector<Subject>& closed_subjects() {
    static const std::vector<Subject> subjects = [] {
        std::vector<Subject> list;
        for (const char* kind : {"knot", "gear", "torus", "sphere"}) list.emplace_back(model_mesh(kind));
        for (const Mesh& mesh : {bumpy_octahedron_mesh(10), frame_mesh(), l_prism_mesh(), tetrahedron_mesh()})
            list.emplace_back(mesh);
        return list;
    }();
    return subjects;
}

const std::vector<Subject>& open_subjects() {
    static const std::vector<Subject> subjects = [] {
        std::vector<Subject> list;
        for (const Mesh& mesh : {bowl_mesh(8), sheet_mesh(8), open_box_mesh(4)}) list.emplace_back(mesh);
        return list;
    }();
    return subjects;
}

std::vector<const Subject*> pointers(const std::vector<Subject>& subjects) {
    std::vector<const Subject*> list;
    list.reserve(subjects.size());
    for (const Subject& subject : subjects) list.push_back(&subject);
    return list;
}

Placement random_placement(const std::vector<const Subject*>& subjects, Random& random) {
    const auto count = static_cast<std::uint32_t>(subjects.size());
    Placement p;
    p.a = subjects[random.below(count)];
    p.b = subjects[random.below(count)];
    p.pose_a = random.rotation();
    p.pose_b = random.rotation();
    const Vec3 middle = 5 * random.in_ball();
    const double apart = 0.3 * (p.a->solid.diagonal + p.b->solid.diagonal);
    p.pose_a.translation = middle - rotate(p.pose_a, p.a->solid.centre);
    p.pose_b.translation = middle + apart * random.in_ball() - rotate(p.pose_b, p.b->solid.centre);
    return p;
}

std::vector<Pair> add_all(Scene& scene, const std::vector<Placement>& placements, bool swapped) {
    std::vector<Pair> pairs;
    for (const Placement& p : placements) {
        const BodyId first = swapped ? scene.add(p.b->shape, p.pose_b) : scene.add(p.a->shape, p.pose_a);
        const BodyId second = swapped ? scene.add(p.a->shape, p.pose_a) : scene.add(p.b->shape, p.pose_b);
        pairs.emplace_back(first, second);
    }
    return pairs;
}

std::vector<std::span<const Contact>> by_pair(std::span<const Contact> contacts, std::size_t pairs) {
    std::vector<std::span<const Contact>> parts;
    std::size_t at = 0;
    for (std::size_t i = 0; i < pairs; ++i) {
        const std::size_t first = at;
        while (at < contacts.size() && contacts[at].body_a.slot == 2 * i) ++at;
        parts.push_back(contacts.subspan(first, at - first));
    }
    return parts;
}

std::vector<Contact> contacts_of_fresh_scene(const Scene& scene, const Settings& settings) {
    Scene fresh(settings);
    const auto ids = scene.bodies();
    std::map<BodyId, BodyId> renamed;
    for (const BodyId id : ids) renamed[id] = fresh.add(scene.shape(id).shared_from_this(), scene.pose(id));
    std::vector<Pair> pairs;
    for (const auto& [a, b] : scene.pairs()) pairs.emplace_back(renamed[a], renamed[b]);
    const auto found = fresh.find_contacts(pairs);
    std::vector<Contact> contacts(found.begin(), found.end());
    for (Contact& c : contacts) c.body_a = ids[c.body_a.slot], c.body_b = ids[c.body_b.slot];
    return contacts;
}

bool same_bits(std::span<const Contact> x, std::span<const Contact> y) {
    // Field by field: a struct's padding has no meaning.
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const Contact& c, const Contact& d) {
        const auto bits = [](float f) { return std::bit_cast<std::uint32_t>(f); };
        const auto wide = [](double f) { return std::bit_cast<std::uint64_t>(f); };
        const auto same = [&](const Vec3& p, const Vec3& q) {
            return wide(p.x) == wide(q.x) && wide(p.y) == wide(q.y) && wide(p.z) == wide(q.z);
        };
        return c.body_a == d.body_a && c.body_b == d.body_b && c.feature == d.feature && same(c.point_a, d.point_a)
               && same(c.point_b, d.point_b) && same(c.normal, d.normal) && bits(c.depth) == bits(d.depth)
               && bits(c.ray_length) == bits(d.ray_length) && bits(c.weight) == bits(d.weight);
    });
}

} // namespace raycontact::reference
