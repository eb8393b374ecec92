// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>

#include <cstdint>

namespace raycontact {

/// Where method `predictive` expects a contact: a vertex that is not in contact, and the triangle of the other body
/// that it would enter through if it moved on along its outward normal (Lehericey et al. 2013, section 3.1). The next
/// step follows its ray from that triangle.
struct Prediction {
    std::uint32_t body_a = 0; ///< its slot, slot_of(id); body_a < body_b
    std::uint32_t body_b = 0;
    VertexBody vertex_body = VertexBody::a;
    std::uint32_t vertex = 0;   ///< source vertex, index of its file
    std::uint32_t triangle = 0; ///< triangle of the other body, index of its file
    Vec3 point;                 ///< the source vertex, world frame, metres
    Vec3 ahead;                 ///< where its outward normal meets the plane of the triangle, world frame, metres
};

} // namespace raycontact
