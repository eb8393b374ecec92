// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "pairs/directed_pairs.h"
#include "pairs/open_pairs.h"

#include <raycontact/contact.h>
#include <raycontact/settings.h>

#include <span>
#include <vector>

namespace raycontact {

/// Pairs with a ball or capsule, and their contacts. The meshes that a round body meets are one surface to it: so a
/// step that asks about one of these pairs asks about all of the body's.
class RoundPairs {
public:
    /// Lists those of a step. few: the pairs that the step asks about, which get the others of round bodies in them; or
    /// null, if it asks about all.
    void list(Executor& executor, std::span<const PlacedBody> bodies, OpenPairs& pairs, PairList* few);
    /// None.
    void clear() { pairs_.resize(0); }
    /// Adds their contacts to those of other pairs, in order.
    void run(Executor& executor, const Settings& settings, std::span<const PlacedBody> bodies,
             std::vector<Contact>& contacts);
    void trim();

private:
    /// A round body, and another of its pairs.
    struct Meeting {
        BodySlot round, other;
        auto operator<=>(const Meeting&) const = default; // NOLINT(modernize-use-nullptr): of clang-tidy 14
    };

    std::vector<BodySlot> rounds_; ///< asked about
    std::vector<char> is_asked_;   ///< by slot: is one of them
    PairList pairs_, of_rounds_;   ///< pairs_: of this step
    std::vector<Meeting> meetings_;
    std::vector<std::vector<Contact>> slices_;
    std::vector<Contact> found_;
};

} // namespace raycontact
