// SPDX-License-Identifier: Apache-2.0
// A contact of edges has its point on the surface of a, whichever body's edge it is.
#include "exact/assemblies.h"
#include "exact/corners.h"
#include "exact/random_solids.h"

#include <raycontact/collide.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace raycontact::exact {
namespace {

using reference::Random;

struct Seen {
    int contacts = 0, off = 0;
    double worst = 0; ///< of a's size
};

// What contacts see is rounded to float32, and moved inward by 1e-7 of the smaller part.
void ask(const Mesh& mesh_a, const Pose& pose_a, const Mesh& mesh_b, const Pose& pose_b, Seen& seen) {
    const auto a = Shape::make(mesh_a), b = Shape::make(mesh_b);
    for (const Contact& contact : collide(*a, pose_a, *b, pose_b)) {
        if (contact.feature.kind != FeatureKind::edges) continue;
        const double off = closest_point(*a, pose_a, contact.point_a)->distance / a->radius();
        ++seen.contacts;
        seen.off += off > 1e-6;
        seen.worst = std::max(seen.worst, off);
        ASSERT_LT(off, 1e-6) << mesh_a.name << " and " << mesh_b.name << ", depth " << contact.depth;
    }
}

TEST(EdgePoints, OfPartsAnyhow) {
    Random random(51);
    Seen seen;
    for (int i = 0; i < 3000; ++i) {
        const Mesh a = i % 4 == 0 ? fine_solid(random) : coarse_solid(random), b = coarse_solid(random);
        Pose pose_a = random.rotation(), pose_b = random.rotation();
        const Vec3 at = random.in_ball();
        const double reach = 0.5 * (Shape::make(a)->radius() + Shape::make(b)->radius());
        pose_b.translation = {reach * at.x, reach * at.y, reach * at.z};
        ask(a, pose_a, b, pose_b, seen);
    }
    EXPECT_GT(seen.contacts, 3000);
    RecordProperty("worst", std::to_string(seen.worst));
}

TEST(EdgePoints, OfPartsInCornersAndFlush) {
    Random random(52);
    Seen seen;
    for (std::uint32_t i = 0; i < 3000; ++i) {
        if (i % 2 == 0) {
            const CornerPair pair = corner_pair(i / 2 % std::size(corner_families), random);
            ask(pair.a, {}, pair.b, pair.pose_b, seen);
            continue;
        }
        const FlushPair pair = flush_pair(i / 2 % flush_kinds, std::pow(10, random.uniform(-5, -1)), random);
        const Pose pose = random.rotation();
        ask(pair.a, pose, pair.b, pose, seen);
    }
    EXPECT_GT(seen.contacts, 3000);
    RecordProperty("worst", std::to_string(seen.worst));
}

} // namespace
} // namespace raycontact::exact
