// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/margins.h"
#include "reference/solid.h"

#include <raycontact/contact.h>
#include <raycontact/settings.h>

#include <vector>

namespace raycontact::reference {

/// One ray of an directed pair (source, target) and what became of it.
struct CastRay {
    std::uint32_t vertex = 0; ///< of the source solid
    bool contact = false;
    std::uint32_t triangle = 0; ///< of the target solid; only with a contact, as all that follows
    Vec3 point;                 ///< world frame
    Vec3 normal; ///< unit, world frame: the outward normal of the face hit, the direction of the ray, or to the nearest
                 ///< point
    double depth = 0;      ///< metres
    double ray_length = 0; ///< metres
    double weight = 1;
    double least_depth = 0; ///< with direction `refined`, where rounding may decide which faces count: the other answer
};

/// Every vertex of `source` inside the bounds of `target`, cast by the rule of contact; in order of vertices.
std::vector<CastRay> cast_all(const Solid& source, const Pose& source_pose, const Solid& target,
                              const Pose& target_pose, Direction direction = Direction::reprojected);

/// The whole result of a pair of bodies (0, 1), in double and in the order of the contract.
struct ReferenceContact {
    Side vertex_body = Side::a;
    FeatureKind kind = FeatureKind::vertex;
    std::uint32_t vertex = 0, triangle = 0; ///< indices of the files; of edges as Contact::edge_a() and edge_b()
    Vec3 point, normal;                     ///< world; normal from A to B
    double depth = 0, ray_length = 0, weight = 1;
};
std::vector<ReferenceContact> find_contacts(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b,
                                            Direction direction = Direction::reprojected);

/// How close the ray of one source vertex is to going another way, whether or not it is inside the bounds.
Margins ray_margins(const Solid& source, const Pose& source_pose, const Solid& target, const Pose& target_pose,
                    std::uint32_t vertex);

} // namespace raycontact::reference
