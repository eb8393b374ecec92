// SPDX-License-Identifier: Apache-2.0
#include "contacts/local_contacts.h"

#include <numeric>

namespace raycontact {

void LocalContacts::set(std::span<const kernels::LocalContact> found, std::span<const std::uint32_t> directed,
                        std::size_t pair_count) {
    places_.assign(2 * pair_count + 1, 0);
    for (const kernels::LocalContact& contact : found) ++places_[directed[contact.pair] + 1];
    std::partial_sum(places_.begin(), places_.end(), places_.begin());
    contacts_.resize(found.size());
    for (const kernels::LocalContact& contact : found) {
        const std::uint32_t pair = directed[contact.pair];
        kernels::LocalContact& own = contacts_[places_[pair]++];
        own = contact;
        own.pair = pair;
    }
}

} // namespace raycontact
