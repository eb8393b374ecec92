// SPDX-License-Identifier: Apache-2.0
// Speculative contacts of two boxes by hand: the gap below a corner, and a corner on its way. speculative_test of
// property holds them against brute force.
#include "speculative/vertex_search.h"

#include "prepared_shape.h"
#include "reference/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace raycontact {
namespace {

using namespace reference;

struct Boxes {
    std::shared_ptr<const Shape> small, large;
    PlacedBody a, b;
    /// The small one above the large one by `gap`, and by `next` at the next step.
    Boxes(double gap, double next)
        : small(prepared_shape(box_mesh({0.5, 0.5, 0.5}))), large(prepared_shape(box_mesh({2, 2, 0.5}))) {
        a.shape = small.get();
        b.shape = large.get();
        a.pose.translation = {0.1, 0.2, 1 + gap};
        a.centred = a.next = centred_pose(*small, a.pose);
        a.next.translation.z = 1 + next;
        b.centred = b.next = centred_pose(*large, b.pose);
    }

    /// Of all vertices of the small one with all faces of the large one near.
    std::vector<FeatureContact> found(double margin, std::span<const std::uint32_t> lower = {}) const {
        std::vector<NearEdge> near;
        for (std::uint32_t v = 0; v < small->vertices().size(); ++v)
            for (std::uint32_t f = 0; f < large->triangles().size(); ++f) near.push_back({v, f, 0});
        std::vector<kernels::LocalContact> touching;
        for (const std::uint32_t v : lower) touching.push_back({0, v, 0, 0, 1, {0, 0, 1}});
        std::vector<FeatureContact> contacts;
        VertexSearch().find(SpeculativePair(a, b, margin), {std::span(near), {}}, {std::span(touching), {}}, contacts);
        return contacts;
    }
};

TEST(SpeculativePair, TheFourLowerCornersAreNearWithinTheMargin) {
    const Boxes still(0.01, 0.01);
    const auto contacts = still.found(0.02);
    ASSERT_EQ(contacts.size(), 4u);
    for (const FeatureContact& c : contacts) {
        EXPECT_EQ(c.source, Side::a);
        EXPECT_NEAR(c.depth, -0.01, 1e-6) << "minus the gap";
    }
    EXPECT_TRUE(still.found(0.009).empty()) << "beyond the margin";
}

TEST(SpeculativePair, ACornerThatTouchesHasNoOther) {
    const Boxes still(0.01, 0.01);
    std::vector<std::uint32_t> lower;
    for (std::uint32_t v = 0; v < still.small->vertices().size(); ++v)
        if (still.small->vertices()[v].z < 0) lower.push_back(v);
    ASSERT_EQ(lower.size(), 4u);
    EXPECT_EQ(still.found(0.02, std::span(lower).first(1)).size(), 3u);
    EXPECT_TRUE(still.found(0.02, lower).empty());
}

TEST(SpeculativePair, ACornerOnItsWayIsToldWhateverTheMargin) {
    const Boxes falling(0.3, -0.1); // it will be through the surface at the next step
    const auto contacts = falling.found(0.001);
    ASSERT_EQ(contacts.size(), 4u);
    for (const FeatureContact& c : contacts) EXPECT_NEAR(c.depth, -0.3, 1e-6);
    EXPECT_TRUE(Boxes(0.3, 0.2).found(0.001).empty()) << "it stops before it";
}

} // namespace
} // namespace raycontact
