// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "pairs/directed_pairs.h"

#include <raycontact/contact.h>

#include <span>
#include <vector>

namespace raycontact {

/// Finds the vertices that are to enter the other body on their way to the next step (docs/continuous.md). Works on the
/// host, in double, for every device.
class ComingContacts {
public:
    /// next: of the body frames, by slot. pairs: sorted.
    void run(Executor& executor, Direction direction, std::span<const PlacedBody> bodies, std::span<const Pose> next,
             std::span<const SlotPair> pairs);
    void clear() { contacts_.clear(); }
    std::span<const Contact> contacts() const { return contacts_; }

private:
    std::vector<Contact> contacts_;
    std::vector<std::vector<Contact>> blocks_; ///< of some pairs each
};

} // namespace raycontact
