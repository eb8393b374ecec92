// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/directed_pairs.h"

#include <raycontact/prediction.h>

#include <span>
#include <vector>

namespace raycontact {

/// A ray that the next step follows.
struct KeptRay {
    SlotPair pair;
    bool from_a = false;        ///< its vertex is one of the pair's first body
    std::uint32_t vertex = 0;   ///< of the source's shape
    std::uint32_t triangle = 0; ///< of the other shape, where the walk begins
};

/// The kept rays that are no contacts, sorted as contacts. contacts: of the same step.
std::vector<Prediction> find_predictions(std::span<const KeptRay> rays, std::span<const PlacedBody> bodies,
                                         std::span<const Contact> contacts);

} // namespace raycontact
