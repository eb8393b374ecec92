// SPDX-License-Identifier: Apache-2.0
#include "pairs/by_pair.h"

#include "device/host_kernels.h"

#include "reference/random.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>

namespace raycontact {
namespace {

// Directed pairs in slots that are in any order, as after many pairs have come and gone, or in theirs.
TEST(ByPair, IsInTheOrderOfThePairsWhateverTheirSlots) {
    reference::Random random(1);
    Executor executor(2);
    ByPair<kernels::LocalContact> all;
    for (int round = 0; round < 300; ++round) {
        const std::uint32_t pairs = round % 100 == 99 ? 20'000 : random.below(40); // many slices
        std::vector<std::uint32_t> directed(2 * std::size_t{pairs});
        std::iota(directed.begin(), directed.end(), 0U);
        for (std::size_t i = directed.size(); i > 1 && round % 3 > 0; --i)
            std::swap(directed[i - 1], directed[random.below(static_cast<std::uint32_t>(i))]);
        std::vector<std::pair<std::uint32_t, std::uint32_t>> expected; // directed index, vertex
        std::vector<kernels::LocalContact> found;
        std::uint32_t vertex = 0;
        for (std::uint32_t i = 0; i < directed.size(); ++i)
            for (std::uint32_t n = random.below(4); n > 0; --n) {
                found.push_back({i, vertex, 0, 0, 0, {}});
                expected.emplace_back(directed[i], vertex++);
            }
        all.set(
            executor, std::span<const kernels::LocalContact>(found), [&](std::uint32_t i) { return directed[i]; },
            pairs);
        std::sort(expected.begin(), expected.end()); // those of a pair keep their order
        ASSERT_EQ(all.all().size(), expected.size());
        std::vector<std::size_t> counts(2 * std::size_t{pairs});
        for (const auto& [d, own] : expected) ++counts[d];
        for (std::uint32_t d = 0; d < 2 * pairs; ++d) EXPECT_EQ(all.of(d).size(), counts[d]);
        for (std::size_t i = 0; i < expected.size(); ++i) {
            EXPECT_EQ(all.all()[i].pair, expected[i].first);
            EXPECT_EQ(all.all()[i].vertex, expected[i].second);
        }
    }
}

} // namespace
} // namespace raycontact
