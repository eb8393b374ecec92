// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contacts/contact_store.h"
#include "executor/executor.h"
#include "executor/row_slices.h"
#include "pairs/directed_pairs.h"

#include <raycontact/manifold.h>
#include <raycontact/settings.h>

#include <array>
#include <vector>

namespace raycontact {

/// Leaves the contacts that stand for all, where the settings ask for fewer (docs/conventions.md, Fewer contacts). Each
/// pair is looked at alone, its contacts in their order, so no device and no thread changes what stays.
class ContactReducer {
public:
    /// contacts: of some pairs, all of each, sorted; last: of the last step, for the points that were there. Contacts
    /// that stay keep their order.
    void run(Executor& executor, const Settings& settings, std::span<const PlacedBody> bodies, const ContactStore& last,
             std::vector<Contact>& contacts);
    /// Of the last run: those that say what another says, and those left out.
    std::uint64_t merged() const { return merged_; }
    /// Sorted; may be taken.
    std::vector<Contact>& left_out() { return left_out_; }
    void clear();
    void trim();

private:
    struct Work {
        std::vector<ManifoldPoint> points;
        std::vector<ManifoldPatch> patches;
        std::vector<std::vector<std::uint32_t>> chosen; ///< by patch
    };
    void rank(Work& work, std::span<const PlacedBody> bodies, const ContactStore& last,
              std::span<const Contact> contacts, std::span<std::uint32_t> ranks) const;
    void keep_budget(std::uint64_t most, std::span<const Contact> contacts);
    void divide(Executor& executor, const RowSlices& rows, std::vector<Contact>& contacts);

    /// What stays of some pairs in a row, and what does not.
    struct Slice {
        std::size_t kept, left_out;
        std::uint64_t merged;
    };
    std::vector<std::uint32_t> ranks_; ///< of each contact in its pair: 0 for the deepest; a name below for others
    std::vector<std::uint32_t> rest_;  ///< contacts that the budget may leave out
    std::vector<Slice> slices_;
    std::vector<Contact> kept_, left_out_;
    std::uint64_t merged_ = 0;
};

} // namespace raycontact
