// SPDX-License-Identifier: Apache-2.0
#include "contacts/vertex_order.h"

#include "reference/random.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <set>
#include <vector>

namespace raycontact {
namespace {

// Few and many contacts, of vertices near each other and far apart, up to the largest number there is.
TEST(VertexOrder, IsThatOfSorting) {
    reference::Random random(1);
    for (const std::uint32_t span : {250u, 0x7fffu, 0x8000u, 0x10000u, 0x7fffffffu, 0xffffffffu}) {
        for (std::uint32_t count = 0; count < 200; ++count) {
            const std::uint32_t least = random.below(0xffffffffu - span + 1);
            std::set<std::uint32_t> vertices;
            if (count > 1) vertices = {least, least + span}; // the whole span
            while (vertices.size() < count) vertices.insert(least + random.below(span));
            std::vector<std::uint64_t> keys;
            keys.reserve(vertices.size());
            for (const std::uint32_t vertex : vertices)
                keys.push_back(std::uint64_t{vertex} << 32 | random.below(1000));
            std::vector<std::uint64_t> sorted = keys;
            for (std::size_t i = keys.size(); i > 1; --i)
                std::swap(keys[i - 1], keys[random.below(static_cast<std::uint32_t>(i))]);
            sort_by_vertex(keys);
            ASSERT_EQ(keys, sorted) << count << " contacts, vertices " << least << " to " << least + span;
        }
    }
}

} // namespace
} // namespace raycontact
