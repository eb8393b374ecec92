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
/// pair is looked at alone, its contacts in their order, so no device and no thread changes what stays. One that has
/// what it had keeps its choice, so neither does it matter whether a step asked about it.
class ContactReducer {
public:
    /// The contacts of the last step.
    struct Last {
        const ContactStore &kept, &left_out;
        bool has_settings; ///< they were chosen in the step before, by these settings
    };
    /// contacts: of some pairs, all of each, sorted. Those that stay keep their order.
    /// Of those that await to be refined (Refiner) as many are refined as it takes to know the deepest of each pair.
    void run(Executor& executor, const Settings& settings, std::span<const PlacedBody> bodies, const Last& last,
             std::vector<Contact>& contacts);
    /// Of the last run; sorted; may be taken.
    std::vector<Contact>& left_out() { return left_out_; }
    void clear();
    void trim();

private:
    void rank(std::vector<ManifoldPoint>& points, std::span<const PlacedBody> bodies, const ContactStore& last,
              std::span<const Contact> contacts, std::span<std::uint32_t> ranks) const;
    void keep_budget(std::uint64_t most, std::span<const Contact> contacts);
    void divide(Executor& executor, const RowSlices& rows, std::vector<Contact>& contacts);

    /// What stays of some pairs in a row, and what does not.
    struct Slice {
        std::size_t kept, left_out;
    };
    std::vector<std::uint32_t> ranks_; ///< of each contact in its pair: 0 for the deepest; not_chosen for others
    std::vector<std::uint32_t> rest_;  ///< contacts that the budget may leave out
    std::vector<Slice> slices_;
    std::vector<Contact> kept_, left_out_;
};

} // namespace raycontact
