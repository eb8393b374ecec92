// SPDX-License-Identifier: Apache-2.0
#include "contacts/still_contacts.h"

#include "reference/random.h"

#include <gtest/gtest.h>
#include <stdexcept>
#include <tuple>

namespace raycontact {
namespace {

using Found = std::vector<kernels::LocalContact>;

// Pairs come and go between the two steps, so that their numbers change; of those of both some stand still.
TEST(StillContacts, AreFoundByPairAndDirection) {
    reference::Random random(1);
    for (int round = 0; round < 300; ++round) {
        std::vector<SlotPair> before, now;
        std::vector<std::uint32_t> still;
        Found contacts;
        std::vector<std::tuple<std::uint32_t, std::uint32_t>> expected; // place in still, vertex
        std::uint32_t vertex = 0;
        const std::uint32_t one_in = random.below(2) ? 2 : 15; // stand still
        for (std::uint32_t pair = 0; pair < 40; ++pair) {
            const bool was = random.below(3) != 0, is = random.below(3) != 0;
            const bool asked = was && is && random.below(one_in) == 0;
            for (std::uint32_t direction = 0; direction < 2; ++direction) {
                if (asked) still.push_back(2 * static_cast<std::uint32_t>(now.size()) + direction);
                for (std::uint32_t n = was ? random.below(4) : 0; n > 0; --n) {
                    contacts.push_back(
                        {2 * static_cast<std::uint32_t>(before.size()) + direction, vertex, 0, 0, 0, {}});
                    if (asked) expected.emplace_back(static_cast<std::uint32_t>(still.size()) - 1, vertex);
                    ++vertex;
                }
            }
            if (was) before.emplace_back(pair, pair + 1);
            if (is) now.emplace_back(pair, pair + 1);
        }
        Found found;
        find_still_contacts(before, contacts, now, still, found);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < found.size(); ++i)
            EXPECT_EQ(std::tuple(found[i].pair, found[i].vertex), expected[i]);
    }
}

TEST(StillContacts, OfAPairThatWasNotThereIsAMistake) {
    const Found last{{0, 7, 0, 0, 0, {}}};
    const std::vector<SlotPair> last_pairs{{1, 2}}, others{{1, 3}};
    const std::vector<std::uint32_t> first{0};
    Found found;
    find_still_contacts(last_pairs, last, last_pairs, first, found);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].vertex, 7u);
    EXPECT_THROW(find_still_contacts(last_pairs, last, others, first, found), std::logic_error);
    EXPECT_THROW(find_still_contacts({}, last, last_pairs, first, found), std::logic_error);
}

} // namespace
} // namespace raycontact
