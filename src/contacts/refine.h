// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "pairs/directed_pairs.h"
#include "shape/shape_data.h"

#include <raycontact/contact.h>

#include <array>
#include <span>

namespace raycontact {

/// Direction `refined` (docs/conventions.md#a-contact): of contacts of a pair, the nearest point of the faces by which
/// the vertex can leave. In double on the host, so it is the same for every device. It takes some microseconds a
/// contact, so only those are refined that stay.
class Refiner {
public:
    Refiner(const PlacedBody& a, const PlacedBody& b);

    /// Contacts of rays wait for it: the Placer says so in is_new, which means nothing else before contacts are stored.
    static bool awaits(const Contact& contact) { return contact.is_new; }
    /// Sets triangle, normal and depth of a contact that awaits it; it was placed with direction `reprojected`.
    void refine(Contact& contact) const;
    /// The most that its depth can be once it is refined, metres.
    double most_depth(const Contact& contact) const;

private:
    /// A vertex in the other body's centred frame, and the face that its ray met.
    struct Met {
        const ShapeData &source, &target;
        const Pose& relative; ///< of the source's centred frame in the target's
        std::uint32_t vertex, face;
        Vec3 point;
        double distance; ///< to the face, metres
    };
    Met met(const Contact& contact) const;

    std::array<const PlacedBody*, 2> bodies_;
    std::array<Pose, 2> relative_; ///< by source
    double perturbation_;          ///< metres; what is nearer has no direction of its own
};

/// Refines those that await it. contacts: sorted by pairs.
void refine(Executor& executor, std::span<const PlacedBody> bodies, std::span<Contact> contacts);

} // namespace raycontact
