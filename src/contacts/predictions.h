// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "rays/coherent.h"

#include <raycontact/prediction.h>

#include <span>
#include <vector>

namespace raycontact {

/// The kept rays that are no contacts, sorted as contacts. contacts: of the same step.
std::vector<Prediction> find_predictions(std::span<const KeptRay> rays, std::span<const PlacedBody> bodies,
                                         std::span<const Contact> contacts);

} // namespace raycontact
