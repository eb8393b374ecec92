// SPDX-License-Identifier: Apache-2.0
#include <scenes/depth_watch.h>

#include <gtest/gtest.h>

namespace raycontact::scenes {
namespace {

Contact contact(std::uint32_t a, std::uint32_t vertex, float depth) {
    Contact c;
    c.body_a = {a};
    c.body_b = {9};
    c.feature.index_a = vertex;
    c.depth = depth;
    return c;
}

TEST(DepthWatch, CountsRunsPerKey) {
    DepthWatch watch(0.02);
    const Contact deep = contact(1, 5, 0.03f), other = contact(1, 6, 0.03f), shallow = contact(1, 5, 0.01f);
    watch.add(0, std::vector{deep});
    watch.add(1, std::vector{other, deep}); // any order
    watch.add(2, std::vector{deep});
    watch.add(3, std::vector{shallow, other});
    watch.add(4, std::vector{deep, other});
    EXPECT_EQ(watch.contacts(), 7u);
    EXPECT_EQ(watch.longest_since(0), 3u);
    EXPECT_EQ(watch.longest_since(3), 2u);
    EXPECT_EQ(watch.longest_since(5), 0u);
}

} // namespace
} // namespace raycontact::scenes
