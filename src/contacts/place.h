// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "pairs/directed_pairs.h"

#include <vector>

namespace raycontact {

/// Turns contacts in the targets' frames into world contacts, sorted by pair and key.
/// All are contacts of vertices; the edges' stage sorts its own in. Points are in double.
class Placer {
public:
    /// local: in the order of their directed pairs.
    void run(Executor& executor, Direction direction, std::span<const PlacedBody> bodies,
             std::span<const SlotPair> pairs, std::span<const kernels::LocalContact> local,
             std::vector<Contact>& contacts);

private:
    std::vector<std::uint64_t> order_; ///< of the local contacts: vertex, place
};

} // namespace raycontact
