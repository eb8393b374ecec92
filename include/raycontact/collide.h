// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>
#include <raycontact/error.h>
#include <raycontact/export.h>
#include <raycontact/mesh.h>
#include <raycontact/pose.h>
#include <raycontact/query.h>
#include <raycontact/settings.h>
#include <raycontact/shape.h>

#include <cstdint>
#include <vector>

namespace raycontact {

/// What collide() finds.
struct CollideOptions {
    Direction direction = Direction::reprojected; ///< what normals and depths are made of
    Features features = Features::edges;          ///< what can be in contact
    /// Metres, from 0 to 1e12: surfaces that are apart by up to this have contacts, too, with depth <= 0, minus the
    /// gap.
    double margin = 0;
    std::uint32_t max_contacts_per_pair = 0; ///< those that stand for all, no more than this; 0: all
    std::uint32_t threads = 1;               ///< 0: one per core
};

/// The contacts of two shapes, once, without a scene: those that a Scene with the two bodies at rest would find, sorted
/// alike.
/// `a` is body 0 and `b` body 1; normals point from a to b. Whoever asks about the same shapes step by step keeps a
/// Scene. A thread keeps the memory that a question took, of shapes with few triangles, but neither shape. Safe to call
/// from several threads. Throws InputError for a pose that is not finite and rigid, and for options that make no sense.
RAYCONTACT_API std::vector<Contact> collide(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                                            const CollideOptions& options = {});

} // namespace raycontact
