// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"

#include "slot_pair.h"

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// Of two bodies that have not moved since the last step, its contacts are still true: appends those of some ordered
/// pairs, numbered 2 x pair + direction and ascending, each contact by its pair's place in `ordered`. last: the
/// contacts of that step, by the same numbers of its own pairs, of which all of these were; all sorted. Throws
/// std::logic_error for a pair that was none.
void find_still_contacts(std::span<const SlotPair> last_pairs, std::span<const kernels::LocalContact> last,
                         std::span<const SlotPair> pairs, std::span<const std::uint32_t> ordered,
                         std::vector<kernels::LocalContact>& found);

} // namespace raycontact
