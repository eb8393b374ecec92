// SPDX-License-Identifier: Apache-2.0
#include "contacts/refine.h"

#include "contacts/write_contact.h"

#include "shape/mesh_rays.h"

namespace raycontact {

Refiner::Refiner(const PlacedBody& source, const PlacedBody& target)
    : source_(source.shape->data()), target_(target.shape->data()),
      relative_(relative_pose(target.centred, source.centred)), turned_(target.centred),
      perturbation_(1e-7 * smaller_size(source, target)) {}

void Refiner::refine(Contact& contact, const kernels::LocalContact& local) const {
    const auto nearest_on = [&](const Vec3& p, std::uint32_t face) {
        return nearest_of(p, target_.corner(face, 0), target_.corner(face, 1), target_.corner(face, 2));
    };
    const Vec3 p = transform_point(relative_, source_.point(local.vertex));
    const double to_hit = length(nearest_on(p, local.triangle).point - p);
    const std::uint32_t face =
        nearest_exit(target_, {p, source_, local.vertex, relative_.rotation}, {to_hit, local.triangle}).face;
    const NearestPoint nearest = nearest_on(p, face);
    const Vec3 off = nearest.point - p;
    const double depth = length(off);
    if (!(static_cast<float>(depth) > 0)) return; // on the surface, by rounding
    const bool has_way = nearest.edges != 0 && depth > perturbation_;
    const Vec3 way = rotated(turned_.rotation, has_way ? (1 / depth) * off : unit(area_normal(target_, face)));
    (contact.feature.source == Side::a ? contact.feature.index_b : contact.feature.index_a) =
        target_.mesh.triangle_index[face];
    write_direction(contact, way, static_cast<float>(depth));
}

} // namespace raycontact
