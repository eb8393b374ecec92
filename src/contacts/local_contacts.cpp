// SPDX-License-Identifier: Apache-2.0
#include "contacts/local_contacts.h"

#include <algorithm>

namespace raycontact {

void LocalContacts::add(std::span<const kernels::LocalContact> found, std::span<const std::uint32_t> directed) {
    const std::size_t before = contacts_.size();
    contacts_.insert(contacts_.end(), found.begin(), found.end());
    for (std::size_t i = before; i < contacts_.size(); ++i) contacts_[i].pair = directed[contacts_[i].pair];
}

void LocalContacts::sort(std::size_t pair_count) {
    const auto by_pair = [](const kernels::LocalContact& a, const kernels::LocalContact& b) { return a.pair < b.pair; };
    if (std::is_sorted(contacts_.begin(), contacts_.end(), by_pair)) return;
    firsts_.assign(2 * pair_count + 1, 0);
    for (const kernels::LocalContact& contact : contacts_) ++firsts_[contact.pair + 1];
    for (std::size_t p = 1; p < firsts_.size(); ++p) firsts_[p] += firsts_[p - 1];
    sorted_.resize(contacts_.size());
    for (const kernels::LocalContact& contact : contacts_) sorted_[firsts_[contact.pair]++] = contact;
    contacts_.swap(sorted_);
}

} // namespace raycontact
