// SPDX-License-Identifier: Apache-2.0
#include "contacts/still_contacts.h"

#include <algorithm>
#include <stdexcept>

namespace raycontact {

namespace {

// The first from `at` on that is not before. By doubled strides, since a few may be asked for among thousands, or all.
template <class T, class Before>
std::size_t skip(std::span<const T> values, std::size_t at, Before&& before) {
    std::size_t stride = 1;
    for (; at + stride <= values.size() && before(values[at + stride - 1]); stride *= 2) at += stride;
    const auto rest = values.subspan(at, std::min(stride, values.size() - at));
    return at + static_cast<std::size_t>(std::partition_point(rest.begin(), rest.end(), before) - rest.begin());
}

} // namespace

void find_still_contacts(std::span<const SlotPair> last_pairs, std::span<const kernels::LocalContact> last,
                         std::span<const SlotPair> pairs, std::span<const std::uint32_t> ordered,
                         std::vector<kernels::LocalContact>& found) {
    std::size_t pair = 0, contact = 0;
    for (std::uint32_t i = 0; i < ordered.size(); ++i) {
        const SlotPair& wanted = pairs[ordered[i] / 2];
        pair = skip(last_pairs, pair, [&](const SlotPair& last_pair) { return last_pair < wanted; });
        if (pair == last_pairs.size() || last_pairs[pair] != wanted)
            throw std::logic_error("a pair is said not to have moved, but the last step had no such pair");
        const std::size_t number = 2 * pair + ordered[i] % 2; // in the last step
        contact = skip(last, contact, [&](const kernels::LocalContact& other) { return other.pair < number; });
        for (; contact < last.size() && last[contact].pair == number; ++contact)
            found.emplace_back(last[contact]).pair = i;
    }
}

} // namespace raycontact
