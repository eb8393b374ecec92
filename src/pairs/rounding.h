// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"
#include "pairs/directed_pairs.h"
#include "shape/shape_data.h"

namespace raycontact {

/// What float32 rounding could hide from a certificate, metres: that of two transforms, of the ray test and of a clock,
/// each several times over (docs/internals/certified.md, Rounding).
inline double rounding_margin(const PlacedBody& source, const PlacedBody& target) {
    const double apart = length(source.centred.translation - target.centred.translation);
    return 1e-5 * target.shape->data().diagonal + 4e-6 * (source.shape->data().reach + apart);
}

} // namespace raycontact
