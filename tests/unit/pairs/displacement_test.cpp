// SPDX-License-Identifier: Apache-2.0
// What a pair may have moved is never less than what any point of it did.
#include "pairs/displacement.h"

#include "pairs/motion.h"
#include "property/crowds.h"
#include "reference/meshes.h"
#include "reference/vector.h"
#include "shape/shape_data.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

using namespace reference;

double some_length(Random& random) {
    return std::pow(10.0, random.uniform(-7, 1));
}

Pose moved_a_little(const Pose& pose, Random& random) {
    const Vec3 axis = random.direction();
    const double angle = random.below(4) == 0 ? random.uniform(0, 6) : some_length(random);
    Pose next = composed(small_rotation(axis, angle), pose);
    next.translation = pose.translation + some_length(random) * random.in_ball();
    return next;
}

// As if any body might have moved.
void update(Motion& motion, std::span<const PlacedBody> bodies) {
    static SlotChanges moved;
    moved.forget();
    Executor executor(1);
    motion.update(executor, bodies, moved);
}

/// Tells which bodies moved.
class Moves {
public:
    void update(Motion& motion, std::span<const PlacedBody> bodies) {
        mark(bodies);
        Executor executor(1);
        motion.update(executor, bodies, moved_);
        moved_.step_done();
    }
    void pass(std::span<const PlacedBody> bodies) {
        mark(bodies);
        moved_.step_done();
    }

private:
    void mark(std::span<const PlacedBody> bodies) {
        moved_.make_room(bodies.size());
        for (BodySlot i = 0; i < bodies.size(); ++i)
            if (i >= last_.size() || !same_bits(last_[i].centred, bodies[i].centred)) moved_.mark(i);
        last_.assign(bodies.begin(), bodies.end());
    }

    SlotChanges moved_;
    std::vector<PlacedBody> last_;
};

TEST(Displacement, IsZeroOnlyWithoutAny) {
    Random random(1);
    for (int i = 0; i < 100; ++i) {
        Pose pose = sheared(random.rotation(), random);
        pose.translation = 1e4 * random.in_ball();
        EXPECT_EQ(displacement_bound(pose, pose, 3, shear_bound(pose)), 0.0);
        Pose other = pose;
        other.rotation[i % 9] = std::nextafter(other.rotation[i % 9], 9.0);
        EXPECT_GT(displacement_bound(pose, other, 3, shear_bound(pose)), 0.0);
    }
}

TEST(Displacement, IsNoLessThanThatOfAnyPointAndHardlyMore) {
    Random random(2);
    double loosest = 0;
    for (const bool shear : {false, true})
        for (int i = 0; i < 3000; ++i) {
            const double reach = some_length(random);
            Pose from = random.rotation();
            from.translation = random.in_ball();
            Pose to = moved_a_little(from, random);
            if (shear) from = sheared(from, random), to = sheared(to, random);
            const double bound = displacement_bound(from, to, reach, std::max(shear_bound(from), shear_bound(to)));
            double most = 0;
            for (int k = 0; k < 200; ++k) {
                const Vec3 p = reach * random.direction();
                for (const double sign : {1.0, -1.0})
                    most = std::max(most, length((to.translation - from.translation) + rotate(to, sign * p)
                                                 - rotate(from, sign * p)));
            }
            ASSERT_GE(bound, most * (1 - 1e-9) - 1e-15) << "shear " << shear << ", case " << i;
            if (!shear) loosest = std::max(loosest, bound / (most + 1e-12));
        }
    std::printf("[ counts   ] bounds of rotations exceed what was sampled by a factor of %.4f at most\n", loosest);
    EXPECT_LT(loosest, 1.4143 * 1.03); // the worst of 400 points is not quite the worst of all
}

// The smallest case of what a mirror-like pair of shears can do: the difference is symmetric, of rank one, and its
// spectral norm its whole Frobenius norm.
TEST(Displacement, CountsAShearThatGoes) {
    Pose from;
    from.rotation[0] += 4.4e-5;
    const Pose to;
    EXPECT_GE(turn_bound(from, to, shear_bound(from)), (from.rotation[0] - 1) * (1 - 1e-12));
}

// The source's vertices in the target's frame, both ways, as the narrow phase forms them.
double true_displacement(const PlacedBody& source, const PlacedBody& target, const PlacedBody& source_before,
                         const PlacedBody& target_before) {
    const Pose now = relative_pose(target.centred, source.centred);
    const Pose before = relative_pose(target_before.centred, source_before.centred);
    double most = 0;
    for (const Point3f& p : source.shape->data().points) {
        const Vec3 v{p.x, p.y, p.z};
        most = std::max(most, length((rotate(now, v) + now.translation) - (rotate(before, v) + before.translation)));
    }
    return most;
}

// By how much a random vertex of the source came nearer to one of the target, in whose frame it went straight on.
double came_nearer(const PlacedBody& source, const PlacedBody& target, const PlacedBody& source_before,
                   const PlacedBody& target_before, Random& random) {
    const Pose now = relative_pose(target.centred, source.centred);
    const Pose before = relative_pose(target_before.centred, source_before.centred);
    const auto any = [&](const PlacedBody& body) {
        const auto& points = body.shape->data().points;
        const Point3f& p = points[random.below(static_cast<std::uint32_t>(points.size()))];
        return Vec3{p.x, p.y, p.z};
    };
    const Vec3 v = any(source), q = any(target);
    const Vec3 from = rotate(before, v) + before.translation, to = rotate(now, v) + now.translation;
    double least = 1e300;
    for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0})
        least = std::min(least, length(from + part * (to - from) - q));
    return length(from - q) - least;
}

TEST(Motion, BoundsWhatAPairMovedInEitherFrame) {
    Random random(3);
    Executor executor(1);
    const auto slab = Shape::make(box_mesh({21, 21, 1}));
    const auto small = Shape::make(frame_mesh());
    double tightest = 1e300, worst = 0, tightest_nearer = 1e300;
    for (int story = 0; story < 400; ++story) {
        std::vector<PlacedBody> bodies(3);
        for (std::size_t i = 0; i < 3; ++i) {
            bodies[i].shape = i == story % 3u ? slab.get() : small.get();
            bodies[i].centred = random.rotation();
            bodies[i].centred.translation = 20 * random.in_ball();
        }
        Motion motion, told;
        Moves moves;
        update(motion, bodies);
        moves.update(told, bodies);
        EXPECT_EQ(motion.pair_bound({0, 1}).moved, 0.0) << "nothing has moved yet";
        const int course = story % 5; // one moves; all move; sheared; all move together, far; all move, far away
        if (course == 4) {
            const Vec3 away = std::pow(10.0, random.uniform(5, 8)) * random.direction();
            for (PlacedBody& body : bodies) body.centred.translation = body.centred.translation + away;
            motion = told = {};
            update(motion, bodies);
            moves.update(told, bodies);
        }
        for (int step = 0; step < 5; ++step) {
            const std::vector<PlacedBody> before = bodies;
            const Vec3 together = course == 3 ? 100 * random.in_ball() : Vec3{};
            for (std::size_t i = 0; i < 3; ++i) {
                if (course != 0 || i == 0) bodies[i].centred = moved_a_little(bodies[i].centred, random);
                if (course == 2 && i != 1) bodies[i].centred = sheared(random.rotation(), random);
                bodies[i].centred.translation = bodies[i].centred.translation + together;
            }
            update(motion, bodies);
            if (step == 2)
                moves.pass(bodies);
            else
                moves.update(told, bodies);
            for (const SlotPair& pair : {SlotPair{0, 1}, SlotPair{0, 2}, SlotPair{1, 2}}) {
                const auto [a, b] = pair;
                if (step < 2 || step == 4) {
                    ASSERT_EQ(told.pair_bound(pair).moved, motion.pair_bound(pair).moved) << step;
                    ASSERT_EQ(told.pair_bound(pair).nearer, motion.pair_bound(pair).nearer);
                }
                const double bound = motion.pair_bound(pair).moved;
                const double moved = std::max(true_displacement(bodies[a], bodies[b], before[a], before[b]),
                                              true_displacement(bodies[b], bodies[a], before[b], before[a]));
                ASSERT_GE(bound + (course == 4 ? 1e-6 : 0), moved) << "course " << course;
                const double shear_before = shear_bound(before[a].centred) + shear_bound(before[b].centred);
                const auto exact =
                    displacement_bounds(place_pair(before[a].centred, before[b].centred, shear_before + 1e-15),
                                        place_pair(bodies[a].centred, bodies[b].centred, motion.pair_shear(pair)),
                                        bodies[a].shape->data().reach, bodies[b].shape->data().reach);
                const double slip = course == 4 ? 1e-6 : 1e-12; // of doubles so far away, at tens of metres
                ASSERT_GE(exact[0] + slip, true_displacement(bodies[a], bodies[b], before[a], before[b]));
                ASSERT_GE(exact[1] + slip, true_displacement(bodies[b], bodies[a], before[b], before[a]));
                for (int k = 0; k < 20; ++k) {
                    const double nearer = std::max(came_nearer(bodies[a], bodies[b], before[a], before[b], random),
                                                   came_nearer(bodies[b], bodies[a], before[b], before[a], random));
                    ASSERT_GE(motion.pair_bound(pair).nearer + (course == 4 ? 1e-6 : 1e-12), nearer) << course;
                    if (nearer > 0)
                        tightest_nearer = std::min(tightest_nearer, motion.pair_bound(pair).nearer / nearer);
                }
                if (moved == 0) continue;
                tightest = std::min(tightest, bound / moved);
                if (course != 3) worst = std::max(worst, bound / moved);
            }
        }
        update(motion, bodies);
        EXPECT_EQ(motion.pair_bound({1, 2}).moved, 0.0) << "nothing moves any more";
        moves.update(told, bodies);
        EXPECT_EQ(told.pair_bound({1, 2}).nearer, motion.pair_bound({1, 2}).nearer);
    }
    std::printf("[ counts   ] pair bounds are %.4f to %.1f times what was moved, %.4f times what came nearer\n",
                tightest, worst, tightest_nearer);
    EXPECT_LT(tightest_nearer, 1.2);
    EXPECT_GE(tightest, 1.0);
}

// In the slot of a small one, while no update looked.
TEST(Motion, ABodyDoesNotInheritFromTheOneBeforeInItsSlot) {
    Executor executor(1);
    const auto small = Shape::make(box_mesh({1, 1, 1})), large = Shape::make(box_mesh({40, 1, 1}));
    std::vector<PlacedBody> bodies(2);
    for (PlacedBody& body : bodies) body.shape = small.get();
    Motion motion;
    update(motion, bodies);
    update(motion, bodies);
    bodies[1].shape = large.get();
    bodies[1].generation = 1;
    bodies[0].centred = pose_from_quaternion({0, 0, 0}, 1, 0, 0, 0.01);
    const std::vector<PlacedBody> before{{small.get(), 0, 0, {}, {}}, bodies[1]};
    update(motion, bodies);
    EXPECT_GE(motion.pair_bound({0, 1}).moved, true_displacement(bodies[1], bodies[0], before[1], before[0]));
    bodies[1].centred.translation.x = 100;
    bodies[1].generation = 2;
    update(motion, bodies);
    EXPECT_EQ(motion.pair_speed({1, 1}), 0.0);
    EXPECT_LT(motion.pair_bound({0, 1}).moved, 10.0) << "another body's way";
}

TEST(Motion, KnowsHowFarARelativeRotationIsSheared) {
    Random random(4);
    Executor executor(1);
    const auto shape = Shape::make(tetrahedron_mesh());
    for (int i = 0; i < 500; ++i) {
        std::vector<PlacedBody> bodies(2);
        for (PlacedBody& body : bodies) {
            body.shape = shape.get();
            body.centred = sheared(random.rotation(), random);
        }
        Motion motion;
        update(motion, bodies);
        // Twice the distance from the nearest rotation, to first order.
        EXPECT_GE(motion.pair_shear({0, 1}) * 1.001, shear_bound(relative_pose(bodies[1].centred, bodies[0].centred)));
    }
}

} // namespace
} // namespace raycontact
