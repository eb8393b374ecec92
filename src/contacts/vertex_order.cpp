// SPDX-License-Identifier: Apache-2.0
#include "contacts/vertex_order.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace raycontact {

namespace {

// The number of smaller vertices is a contact's place in the order. Counting has no branch to mispredict; for `few` to
// `many` contacts it is faster than sorting.
constexpr std::size_t few = 8, many = 128, lanes = 16;

// Number: signed, since every processor compares vectors of signed integers; a shorter type gives more lanes.
template <class Number>
void count_smaller(std::span<std::uint64_t> keys, std::uint32_t least) {
    std::array<std::uint64_t, many> unsorted;
    std::array<Number, many> vertex;
    std::copy(keys.begin(), keys.end(), unsorted.begin());
    for (std::size_t i = 0; i < keys.size(); ++i)
        vertex[i] = static_cast<Number>(static_cast<std::uint32_t>(keys[i] >> 32) - least);
    for (std::size_t i = keys.size(); i % lanes != 0; ++i) vertex[i] = 0;
    for (std::size_t first = 0; first < keys.size(); first += lanes) {
        std::array<Number, lanes> smaller{};
        for (std::size_t j = 0; j < keys.size(); ++j)
            for (std::size_t k = 0; k < lanes; ++k)
                smaller[k] = static_cast<Number>(smaller[k] + (vertex[j] < vertex[first + k] ? 1 : 0));
        for (std::size_t k = 0; k < lanes && first + k < keys.size(); ++k)
            keys[static_cast<std::size_t>(smaller[k])] = unsorted[first + k];
    }
}

} // namespace

void sort_by_vertex(std::span<std::uint64_t> keys) {
    if (keys.size() < few || keys.size() > many) {
        std::sort(keys.begin(), keys.end());
        return;
    }
    const auto [least, most] = std::minmax_element(keys.begin(), keys.end());
    const auto first = static_cast<std::uint32_t>(*least >> 32), span = static_cast<std::uint32_t>(*most >> 32) - first;
    if (span <= 0x7fffu)
        count_smaller<std::int16_t>(keys, first);
    else if (span <= 0x7fffffffu)
        count_smaller<std::int32_t>(keys, first);
    else
        std::sort(keys.begin(), keys.end());
}

} // namespace raycontact
