// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "rays/coherent.h"

#include <raycontact/prediction.h>

#include <array>
#include <span>
#include <vector>

namespace raycontact {

/// The kept rays that are no contacts, sorted as contacts. contacts: of the same step, two sorted lists.
std::vector<Prediction> find_predictions(std::span<const KeptRay> rays, std::span<const PlacedBody> bodies,
                                         const std::array<std::span<const Contact>, 2>& contacts);

} // namespace raycontact
