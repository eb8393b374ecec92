// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>

#include <cstdint>

namespace raycontact {

/// Where method `predictive` expects a contact: a vertex that is not in contact, and the triangle of the other body
/// that it would enter through if it moved on along its outward normal (Lehericey et al. 2013, section 3.1). The next
/// step follows its ray from that triangle.
struct Prediction {
    BodyId body_a;          ///< has the lower slot
    BodyId body_b;          ///< has the higher slot
    ContactFeature feature; ///< of kind vertex: the source vertex, and the triangle of the other body
    Vec3 point;             ///< the source vertex, world frame, metres
    Vec3 ahead;             ///< where its outward normal meets the plane of the triangle, world frame, metres
};

} // namespace raycontact
