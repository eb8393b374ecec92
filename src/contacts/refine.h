// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/directed_pairs.h"
#include "shape/shape_data.h"

#include <raycontact/contact.h>

namespace raycontact {

/// Direction `refined` (docs/conventions.md#a-contact): of contacts of one direction of a pair, the nearest point of
/// the faces by which the vertex can leave. In double on the host, so it is the same for every device.
class Refiner {
public:
    Refiner(const PlacedBody& source, const PlacedBody& target);
    /// Sets triangle, normal and depth of a contact that was placed with direction `reprojected`.
    void refine(Contact& contact, const kernels::LocalContact& local) const;

private:
    const ShapeData &source_, &target_;
    Pose relative_;       ///< of the source's centred frame in the target's
    const Pose& turned_;  ///< the target's
    double perturbation_; ///< metres; what is nearer has no direction of its own
};

} // namespace raycontact
