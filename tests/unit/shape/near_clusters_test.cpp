// SPDX-License-Identifier: Apache-2.0
#include "pairs/rounding.h"
#include "property/crowds.h"
#include "reference/margins.h"
#include "reference/meshes.h"
#include "unit/shape/accelerated.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <map>

namespace raycontact {
namespace {

// The rotation that takes one unit vector to another, by the shortest way (Rodrigues).
Pose turned_onto(const Vec3& from, const Vec3& to) {
    const Vec3 v = cross(from, to);
    const double w = 1 / std::max(1e-9, 1 + dot(from, to));
    const double k[9] = {0, -v.z, v.y, v.z, 0, -v.x, -v.y, v.x, 0};
    Pose pose;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            double squared = 0;
            for (std::size_t m = 0; m < 3; ++m) squared += k[3 * i + m] * k[3 * m + j];
            pose.rotation[3 * i + j] += k[3 * i + j] + w * squared;
        }
    return pose;
}

const ShapeData& accelerated_once(const Shape& shape) {
    static std::map<const Shape*, ShapeData> known;
    const auto found = known.find(&shape);
    return found != known.end() ? found->second : known.emplace(&shape, accelerated(shape)).first->second;
}

// A whole block is said to be safe by the ball around its box alone: no vertex of it may be nearer, also where the
// rotation stretches by what pose checks accept.
TEST(NearClusters, IsNoSaferThanItsVertices) {
    reference::Random random(2);
    const auto slab = Shape::make(reference::box_mesh({21, 21, 1}));
    std::vector<std::shared_ptr<const Shape>> shapes = reference::crowd_shapes(reference::Kind::sizes, 0.1);
    shapes.push_back(slab);
    std::uint64_t blocks = 0, skipped = 0;
    double most_over = -1e300; // in margins
    for (int i = 0; i < 6000; ++i) {
        PlacedBody source, target;
        source.shape = i % 2 ? slab.get() : shapes[random.below(static_cast<std::uint32_t>(shapes.size()))].get();
        target.shape = shapes[random.below(static_cast<std::uint32_t>(shapes.size()))].get();
        const ShapeData& from = source.shape->data();
        const ShapeData& to = accelerated_once(*target.shape);
        // A vertex of the source straight between its middle and a corner of the target: nothing is left over.
        const Point3f& p = from.points[random.below(static_cast<std::uint32_t>(from.points.size()))];
        const Point3f& q = to.points[random.below(static_cast<std::uint32_t>(to.points.size()))];
        const Vec3 outward = (1 / length({q.x, q.y, q.z})) * Vec3{q.x, q.y, q.z};
        source.centred = turned_onto((1 / length({p.x, p.y, p.z})) * Vec3{p.x, p.y, p.z}, -1.0 * outward);
        source.centred = reference::sheared(source.centred, random);
        source.centred.translation = Vec3{q.x, q.y, q.z} + 0.01 * random.uniform() * to.diagonal * outward
                                     - transform_point(source.centred, {p.x, p.y, p.z});
        const Pose world = reference::sheared(random.rotation(), random);
        source.centred = reference::composed(world, source.centred);
        target.centred = world;
        kernels::DirectedPair pair;
        place_source(source, target, pair);
        const double margin = rounding_margin(source, target);
        const reference::Solid solid = reference::make_surface(*target.shape);
        const Pose relative = relative_pose(target.centred, source.centred);
        const kernels::SourceTree& tree = from.header.vertices;
        for (kernels::uint block = 0; block < tree.block_count; ++block) {
            kernels::ClusterBlock alone = from.clusters[tree.cluster_first[0] + block / VERTEX_LANES];
            for (kernels::uint lane = 0; lane < VERTEX_LANES; ++lane)
                if (lane != block % VERTEX_LANES) alone.centre[0][lane] = NAN; // an empty lane
            kernels::prototype::Search search{0,    &pair, &tree,     &to.header, &alone, to.clearances.data(),
                                              0.0f, {},    UNBOUNDED, UNBOUNDED};
            ++blocks;
            if (kernels::prototype::near_lanes(&search, &alone) != 0) continue;
            ++skipped;
            for (std::size_t k = 0; k < VERTEX_LANES; ++k) {
                const Vec3 v{from.vertex_blocks[block].position[0][k], from.vertex_blocks[block].position[1][k],
                             from.vertex_blocks[block].position[2][k]};
                if (std::isnan(v.x)) continue;
                const double distance = reference::distance_to_surface(solid, transform_point(relative, v));
                most_over = std::max(most_over, (double(search.least_safe) - distance) / margin);
            }
        }
    }
    std::printf("[ counts   ] %llu of %llu blocks skipped, certificates over the distance by %.3f margins at most\n",
                static_cast<unsigned long long>(skipped), static_cast<unsigned long long>(blocks), most_over);
    EXPECT_LT(most_over, 0.5);
    EXPECT_GT(skipped, 1000u);
}

} // namespace
} // namespace raycontact
