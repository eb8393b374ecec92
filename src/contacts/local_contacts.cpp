// SPDX-License-Identifier: Apache-2.0
#include "contacts/local_contacts.h"

#include <algorithm>

namespace raycontact {

namespace {

bool by_pair(const kernels::LocalContact& a, const kernels::LocalContact& b) {
    return a.pair < b.pair;
}

} // namespace

// Makes one run of the two that begin at first and at second.
void LocalContacts::merge(std::size_t first, std::size_t second) {
    if (first == second || second == contacts_.size()) return;
    const auto at = [this](std::size_t i) { return contacts_.begin() + static_cast<std::ptrdiff_t>(i); };
    merged_.resize(contacts_.size());
    const auto out = std::copy(contacts_.begin(), at(first), merged_.begin());
    std::merge(at(first), at(second), at(second), contacts_.end(), out, by_pair);
    contacts_.swap(merged_);
}

void LocalContacts::add(std::span<const kernels::LocalContact> found, std::span<const std::uint32_t> ordered,
                        std::span<const std::uint32_t> which) {
    const std::size_t before = contacts_.size();
    contacts_.insert(contacts_.end(), found.begin(), found.end());
    std::size_t second = contacts_.size();
    for (std::size_t i = before; i < contacts_.size(); ++i) {
        std::uint32_t& pair = contacts_[i].pair;
        pair = ordered[pair];
        if (!which.empty()) pair = 2 * which[pair / 2] + pair % 2;
        if (i > before && pair < contacts_[i - 1].pair) second = i;
    }
    merge(before, second);
    merge(0, before);
}

} // namespace raycontact
