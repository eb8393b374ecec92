// SPDX-License-Identifier: Apache-2.0
#include "contacts/still_contacts.h"

#include <stdexcept>

namespace raycontact {

void find_still_contacts(std::span<const Pair> last_pairs, std::span<const kernels::LocalContact> last,
                         std::span<const Pair> pairs, std::span<const std::uint32_t> ordered,
                         std::vector<kernels::LocalContact>& found) {
    std::size_t pair = 0, contact = 0;
    for (std::uint32_t i = 0; i < ordered.size(); ++i) {
        const Pair& wanted = pairs[ordered[i] / 2];
        while (pair < last_pairs.size() && last_pairs[pair] < wanted) ++pair;
        if (pair == last_pairs.size() || last_pairs[pair] != wanted)
            throw std::logic_error("a pair is said not to have moved, but the last step had no such pair");
        const std::size_t number = 2 * pair + ordered[i] % 2; // in the last step
        while (contact < last.size() && last[contact].pair < number) ++contact;
        for (; contact < last.size() && last[contact].pair == number; ++contact)
            found.emplace_back(last[contact]).pair = i;
    }
}

} // namespace raycontact
