// SPDX-License-Identifier: Apache-2.0
#include "contacts/last_contacts.h"

#include <stdexcept>

namespace raycontact {

void LastContacts::keep(std::span<const Pair> pairs, LocalContacts& contacts) {
    pairs_.assign(pairs.begin(), pairs.end());
    contacts.give(contacts_);
}

void LastContacts::clear() {
    pairs_.clear();
    contacts_.clear();
}

void LastContacts::find(std::span<const Pair> pairs, std::span<const std::uint32_t> ordered,
                        std::vector<kernels::LocalContact>& found) const {
    std::size_t pair = 0, contact = 0;
    for (std::uint32_t i = 0; i < ordered.size(); ++i) {
        const Pair& wanted = pairs[ordered[i] / 2];
        while (pair < pairs_.size() && pairs_[pair] < wanted) ++pair;
        if (pair == pairs_.size() || pairs_[pair] != wanted)
            throw std::logic_error("a pair is said not to have moved, but the last step had no such pair");
        const std::size_t number = 2 * pair + ordered[i] % 2; // in the last step
        while (contact < contacts_.size() && contacts_[contact].pair < number) ++contact;
        for (; contact < contacts_.size() && contacts_[contact].pair == number; ++contact)
            found.emplace_back(contacts_[contact]).pair = i;
    }
}

} // namespace raycontact
