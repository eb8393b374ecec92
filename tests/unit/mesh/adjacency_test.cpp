// SPDX-License-Identifier: Apache-2.0
#include "mesh/adjacency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

using namespace raycontact;

namespace {

// Few vertices, so that many triangles share an edge, and some have a vertex twice or three times.
std::vector<Triangle> random_triangles(std::mt19937& random, std::uint32_t count, std::uint32_t vertices) {
    std::vector<Triangle> triangles(count);
    for (Triangle& t : triangles)
        for (std::uint32_t& v : t) v = static_cast<std::uint32_t>(random() % vertices);
    return triangles;
}

TEST(Adjacency, HalfEdgesAreAllSidesInOrder) {
    std::mt19937 random(4);
    for (const std::uint32_t count : {0u, 1u, 7u, 200u})
        for (const std::uint32_t vertices : {1u, 4u, 60u}) {
            const std::vector<Triangle> triangles = random_triangles(random, count, vertices);
            std::vector<HalfEdge> expected;
            for (std::uint32_t i = 0; i < 3 * count; ++i) {
                const std::uint32_t from = triangles[i / 3][i % 3], to = triangles[i / 3][(i + 1) % 3];
                if (from != to) expected.push_back({std::min(from, to), std::max(from, to), i, from < to});
            }
            std::sort(expected.begin(), expected.end());
            EXPECT_EQ(sorted_half_edges(triangles), expected) << count << " triangles, " << vertices << " vertices";
        }
}

} // namespace
