// SPDX-License-Identifier: Apache-2.0
#include "contacts/local_contacts.h"

#include "reference/random.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

// A crowd of ordered pairs, each of which one of three methods has looked at: one names its pairs in two runs, one is
// given some of the pairs only.
TEST(LocalContacts, AreInTheOrderOfThePairsWhoeverFoundThem) {
    reference::Random random(1);
    LocalContacts all;
    for (int round = 0; round < 300; ++round) {
        all.clear();
        std::vector<std::uint32_t> ordered[3], which;
        const std::uint32_t pairs = random.below(40);
        for (std::uint32_t pair = 0; pair < pairs; ++pair) {
            const std::uint32_t method = random.below(4); // 3: nobody
            if (method == 2) which.push_back(pair);
            for (std::uint32_t direction = 0; direction < 2 && method < 3; ++direction)
                ordered[method].push_back(2 * (method == 2 ? std::uint32_t(which.size()) - 1 : pair) + direction);
        }
        std::stable_partition(ordered[0].begin(), ordered[0].end(),
                              [&](std::uint32_t) { return random.below(2) == 0; });
        std::vector<std::pair<std::uint32_t, std::uint32_t>> expected; // pair, vertex
        std::uint32_t vertex = 0;
        for (std::uint32_t method = 0; method < 3; ++method) {
            std::vector<kernels::LocalContact> found;
            for (std::uint32_t i = 0; i < ordered[method].size(); ++i) {
                const std::uint32_t own = ordered[method][i];
                for (std::uint32_t n = random.below(4); n > 0; --n) {
                    found.push_back({i, vertex, 0, 0, 0, {}});
                    expected.emplace_back(method == 2 ? 2 * which[own / 2] + own % 2 : own, vertex++);
                }
            }
            all.add(found, ordered[method],
                    method == 2 ? std::span<const std::uint32_t>(which) : std::span<const std::uint32_t>());
        }
        std::sort(expected.begin(), expected.end()); // what one method found of a pair keeps its order
        ASSERT_EQ(all.contacts().size(), expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i) {
            EXPECT_EQ(all.contacts()[i].pair, expected[i].first);
            EXPECT_EQ(all.contacts()[i].vertex, expected[i].second);
        }
    }
}

} // namespace
} // namespace raycontact
