// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"
#include "pairs/directed_pairs.h"

#include <raycontact/contact.h>

namespace raycontact {

inline BodyId id_in(std::span<const PlacedBody> bodies, BodySlot slot) {
    return {slot, bodies[slot].generation};
}

/// Whose ray it is, and what it meets; indices of the files.
inline ContactFeature vertex_feature(bool from_a, std::uint32_t vertex, std::uint32_t triangle,
                                     FeatureKind kind = FeatureKind::vertex) {
    return from_a ? ContactFeature{kind, Side::a, vertex, triangle} : ContactFeature{kind, Side::b, triangle, vertex};
}

/// Sets normal, depth and the point on the other body. out: the direction in which the source leaves the other body,
/// world frame, unit. The source's point is there already.
inline void write_direction(Contact& contact, const Vec3& out, float depth) {
    const bool from_a = contact.feature.source == Side::a;
    const double sign = from_a ? -1 : 1;
    contact.normal.x = static_cast<float>(sign * out.x);
    contact.normal.y = static_cast<float>(sign * out.y);
    contact.normal.z = static_cast<float>(sign * out.z);
    contact.depth = depth;
    const Vec3 normal = contact.normal;
    const double by = sign * double(depth);
    const Vec3& own = from_a ? contact.point_a : contact.point_b;
    Vec3& other = from_a ? contact.point_b : contact.point_a;
    other.x = own.x + by * normal.x;
    other.y = own.y + by * normal.y;
    other.z = own.z + by * normal.z;
}

/// Writes a contact in place, all but is_new. point: the source's, world frame.
inline void write_contact(Contact& contact, BodyId a, BodyId b, const ContactFeature& feature, const Vec3& point,
                          const Vec3& out, float depth, float ray_length, float weight) {
    contact.body_a = a;
    contact.body_b = b;
    contact.feature = feature;
    Vec3& own = feature.source == Side::a ? contact.point_a : contact.point_b;
    own.x = point.x;
    own.y = point.y;
    own.z = point.z;
    contact.ray_length = ray_length;
    contact.weight = weight;
    write_direction(contact, out, depth);
}

} // namespace raycontact
