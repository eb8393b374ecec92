// SPDX-License-Identifier: Apache-2.0
// Bodies that a separating normal parts are at least as far apart, and stay so on their way.
#include "pairs/separating_normal.h"

#include "pairs/displacement.h"
#include "prepared_shape.h"
#include "property/crowds.h"
#include "reference/margins.h"
#include "reference/meshes.h"
#include "reference/vector.h"
#include "shape/shape_data.h"

#include <algorithm>
#include <cstdio>
#include <gtest/gtest.h>
#include <map>

namespace raycontact {
namespace {

using namespace reference;

const Solid& surface_of(const Shape& shape) {
    static std::map<const Shape*, Solid> known;
    const auto found = known.find(&shape);
    return found != known.end() ? found->second : known.emplace(&shape, make_surface(shape)).first->second;
}

// The least distance of a vertex of the source from the target, at some times of its straight way in the target's
// frame.
double distance_on_way(const PlacedBody& source, const PlacedBody& target, bool on_way) {
    const Pose now = relative_pose(target.centred, source.centred), next = relative_pose(target.next, source.next);
    double least = 1e300;
    for (const Point3f& point : source.shape->data().points) {
        const Vec3 v{point.x, point.y, point.z}, from = transform_point(now, v), to = transform_point(next, v);
        for (const double t : {0.0, 0.3, 0.7, 1.0}) {
            least = std::min(least, distance_to_surface(surface_of(*target.shape), from + t * (to - from)));
            if (!on_way) break;
        }
    }
    return least;
}

TEST(SeparatingNormal, PartsNothingThatIsNearer) {
    Random random(3);
    const auto& shapes = crowd_shapes(Kind::sizes, 0.1);
    std::size_t parted = 0, apart = 0;
    double least_spare = 1e300;
    for (int i = 0; i < 400; ++i) {
        PlacedBody a, b;
        const auto some = [&] { return shapes[random.below(static_cast<std::uint32_t>(shapes.size()))].get(); };
        a.shape = some();
        b.shape = some();
        a.shape->prepare();
        b.shape->prepare();
        const double size = std::min(a.shape->data().diagonal, b.shape->data().diagonal);
        a.centred = sheared(random.rotation(), random);
        b.centred = sheared(random.rotation(), random);
        const double far = random.uniform(0.5, 1.1) * (a.shape->data().reach + b.shape->data().reach);
        b.centred.translation = 100 * random.in_ball();
        a.centred.translation = b.centred.translation + far * random.direction();
        a.next = composed(small_rotation(random.direction(), 0.2), a.centred);
        a.next.translation = a.centred.translation + 0.2 * size * random.in_ball();
        b.next = b.centred;
        SeparatingNormal normal;
        const double enough = 0.01 * size;
        for (const bool on_way : {false, true})
            for (int step = 0; step < 3; ++step) { // the later ones go on from what was found
                const double gap = normal.gap(a, b, enough, on_way);
                if (step < 2) continue;
                const double distance = std::min(distance_on_way(a, b, on_way), distance_on_way(b, a, on_way));
                apart += distance > 0.05 * size;
                if (!(gap > enough)) continue;
                ++parted;
                least_spare = std::min(least_spare, (distance - gap) / size);
            }
    }
    std::printf("[ counts   ] %zu parted, %zu are apart; the nearest has %.2g of its size to spare\n", parted, apart,
                least_spare);
    EXPECT_GT(least_spare, -1e-5);
    EXPECT_GT(parted, 300u);
    EXPECT_GT(10 * parted, 7 * apart) << "most that are apart are parted";
}

TEST(SeparatingNormal, KnowsNothingUntilShapesArePrepared) {
    const auto box = Shape::make(box_mesh({1, 1, 1}));
    PlacedBody a, b;
    a.shape = b.shape = box.get();
    a.centred.translation = {3, 0, 0};
    EXPECT_EQ(SeparatingNormal().gap(a, b, 0.1, false), 0);
    box->prepare();
    EXPECT_NEAR(SeparatingNormal().gap(a, b, 0.1, false), 1, 0.01);
}

// A rotation may stretch by 1e-4, and the gap is of the frame where it is least.
TEST(SeparatingNormal, IsNoWiderInOneFrameThanInTheOther) {
    const auto box = prepared_shape(box_mesh({1, 1, 1}));
    PlacedBody a, b;
    a.shape = b.shape = box.get();
    a.centred.translation = {1000, 0, 0};
    for (const double stretch : {-5e-5, 5e-5}) {
        b.centred.rotation[0] = 1 + stretch;
        const double in_b = length(relative_pose(b.centred, a.centred).translation) - 1 - (1 + stretch);
        const double in_a = length(relative_pose(a.centred, b.centred).translation) - 1 - (1 + stretch);
        EXPECT_LE(SeparatingNormal().gap(a, b, 0.1, false), std::min(in_a, in_b) + 1e-6);
    }
}

} // namespace
} // namespace raycontact
