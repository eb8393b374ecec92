// SPDX-License-Identifier: Apache-2.0
#include "contacts/refine.h"

#include "contacts/write_contact.h"
#include "executor/row_slices.h"
#include "slot_pair.h"

#include "shape/mesh_rays.h"

#include <algorithm>

namespace raycontact {

namespace {

NearestPoint nearest_on(const ShapeData& mesh, const Vec3& p, std::uint32_t face) {
    return nearest_of(p, mesh.corner(face, 0), mesh.corner(face, 1), mesh.corner(face, 2));
}

/// Where the file's index is first; most lists count through.
std::size_t place_of(std::span<const std::uint32_t> indices, std::uint32_t index) {
    if (index < indices.size() && indices[index] == index && (index == 0 || indices[index - 1] != index)) return index;
    return static_cast<std::size_t>(std::ranges::lower_bound(indices, index) - indices.begin());
}

} // namespace

Refiner::Refiner(const PlacedBody& a, const PlacedBody& b)
    : bodies_{&a, &b}, relative_{relative_pose(b.centred, a.centred), relative_pose(a.centred, b.centred)},
      perturbation_(1e-7 * smaller_size(a, b)) {}

Refiner::Met Refiner::met(const Contact& contact) const {
    const auto side = static_cast<std::size_t>(contact.feature.source);
    const ShapeData &source = bodies_[side]->shape->data(), &target = bodies_[1 - side]->shape->data();
    Met met{source, target, relative_[side], {}, NONE, {}, 0};
    met.vertex = static_cast<std::uint32_t>(place_of(source.mesh.vertex_index, contact.feature.source_index()));
    met.point = transform_point(met.relative, source.point(met.vertex));
    const std::vector<std::uint32_t>& faces = target.mesh.triangle_index;
    const std::uint32_t hit = contact.feature.other_index();
    const std::size_t first = place_of(faces, hit);
    met.face = static_cast<std::uint32_t>(first);
    // The pieces of a triangle that parts cut are named alike: the nearest stands for the one that was met.
    if (first + 1 < faces.size() && faces[first + 1] == hit) met.face = nearest_piece(target, met.point, hit).face;
    met.distance = length(nearest_on(target, met.point, met.face).point - met.point);
    return met;
}

double Refiner::most_depth(const Contact& contact) const {
    const double distance = met(contact).distance;
    return distance > 0 ? distance : double(contact.depth);
}

void Refiner::refine(Contact& contact) const {
    const Met met = this->met(contact);
    contact.is_new = false;
    const std::uint32_t face =
        nearest_exit(met.target, {met.point, met.source, met.vertex, met.relative.rotation}, {met.distance, met.face})
            .face;
    const NearestPoint nearest = nearest_on(met.target, met.point, face);
    const Vec3 off = nearest.point - met.point;
    const double depth = length(off);
    if (!(static_cast<float>(depth) > 0)) return; // on the surface, by rounding
    const bool has_way = nearest.edges != 0 && depth > perturbation_;
    const bool from_a = contact.feature.source == Side::a;
    const Vec3 way = rotated(bodies_[from_a ? 1 : 0]->centred.rotation,
                             has_way ? (1 / depth) * off : unit(area_normal(met.target, face)));
    (from_a ? contact.feature.index_b : contact.feature.index_a) = met.target.mesh.triangle_index[face];
    write_direction(contact, way, static_cast<float>(depth));
}

void refine(Executor& executor, std::span<const PlacedBody> bodies, std::span<Contact> contacts) {
    const RowSlices rows{contacts.size(), 64};
    // Those of a pair need not go together: a pair of fine meshes may have most of them.
    rows.each(
        executor, [](std::size_t) { return false; },
        [&](std::uint32_t, std::size_t begin, std::size_t end) {
            while (begin < end) {
                const auto [a, b] = pair_of(contacts[begin]);
                const Refiner refiner(bodies[a], bodies[b]);
                for (const SlotPair pair{a, b}; begin < end && pair_of(contacts[begin]) == pair; ++begin)
                    if (Refiner::awaits(contacts[begin])) refiner.refine(contacts[begin]);
            }
        });
}

} // namespace raycontact
