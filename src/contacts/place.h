// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "pairs/by_pair.h"
#include "pairs/directed_pairs.h"

#include <raycontact/contact.h>

#include <span>
#include <vector>

namespace raycontact {

/// Contacts of one pair that are placed already, sorted by key, and how many those of the pairs before it have.
struct PlacedContacts {
    std::uint32_t pair; ///< its place
    std::uint32_t before;
    std::span<const Contact> contacts; ///< some
};

/// Turns contacts in the targets' frames into world contacts, sorted by pair and key. Points are in double.
class Placer {
public:
    /// local: the contacts of vertices. placed: in the order of their pairs; sorted in.
    void run(Executor& executor, Direction direction, std::span<const PlacedBody> bodies,
             std::span<const SlotPair> pairs, const ByPair<kernels::LocalContact>& local,
             std::span<const PlacedContacts> placed, std::vector<Contact>& contacts);

private:
    std::vector<std::uint64_t> order_; ///< of the local contacts: vertex, place
};

} // namespace raycontact
