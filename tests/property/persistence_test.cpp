// SPDX-License-Identifier: Apache-2.0
// Bodies that hardly move keep their contacts: the same keys, at the same points of the features.
#include "property/shapes.h"
#include "reference/vector.h"

#include <raycontact/scene.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

/// Turned and shifted by a part of the size.
Pose nudged(const Pose& pose, double by, double size, Random& random) {
    Pose moved = pose;
    const Vec3 axis = random.direction(), way = random.direction();
    auto& r = moved.rotation;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 column{r[k], r[3 + k], r[6 + k]}, turned = column + by * cross(axis, column);
        r[k] = turned.x;
        r[3 + k] = turned.y;
        r[6 + k] = turned.z;
    }
    moved = nearest_rigid_pose(moved);
    moved.translation = moved.translation + by * size * way;
    return moved;
}

/// Of one feature: contacts that are there in both steps, and those that went or came.
struct Kept {
    std::uint64_t kept = 0, changed = 0;
    std::uint64_t jumps = 0; ///< along the feature, by more than a hundredth of the smaller body's size
    double farthest = 0;     ///< of all points, in such sizes
};
using Keys = std::map<std::pair<BodyId, std::uint64_t>, Contact>;

Keys by_key(std::span<const Contact> contacts) {
    Keys keys;
    for (const Contact& c : contacts) keys.emplace(std::pair(c.body_a, c.key()), c);
    return keys;
}

using Features = std::array<Kept, 4>; // vertices, edges; then the same before they touch

/// One on the other, flat face on flat face, hardly in it; every third square on it.
void lay_flush(Placement& p, Random& random) {
    const double size = std::min(p.a->solid.diagonal, p.b->solid.diagonal);
    const auto off = [&] { return random.below(3) == 0 ? 0 : random.uniform(-0.3, 0.3) * size; };
    p.pose_a = p.pose_b = Pose();
    const double yaw = random.below(3) == 0 ? 0 : random.uniform(0, 6.28);
    p.pose_b.rotation = {std::cos(yaw), -std::sin(yaw), 0, std::sin(yaw), std::cos(yaw), 0, 0, 0, 1};
    const double deep = size * std::pow(10, -random.uniform(2.5, 6));
    p.pose_b.translation = {off(), off(), p.a->shape->box_max().z - p.b->shape->box_min().z - deep};
    p.pose_b = nudged(p.pose_b, std::pow(10, -random.uniform(3, 7)), size, random);
}

/// Pairs that are moved by a part of their size, once each.
Features move(std::size_t batches, double by, bool flush = false) {
    std::vector<const Subject*> subjects;
    for (const Subject& s : closed_subjects())
        if (!flush || s.solid.name == "box" || s.solid.name == "frame" || s.solid.name == "L prism")
            subjects.push_back(&s);
    Random random(20260101);
    Features found;
    for (std::size_t batch = 0; batch < batches; ++batch) {
        Settings settings;
        settings.speculative = Speculative::on;
        settings.speculative_margin = 0.03;
        Scene scene(settings);
        std::vector<Placement> placements;
        for (std::size_t i = 0; i < 100; ++i) {
            placements.push_back(random_placement(subjects, random));
            if (flush) lay_flush(placements.back(), random);
        }
        const auto pairs = add_all(scene, placements);
        const Keys before = by_key(scene.find_contacts(pairs));
        for (std::size_t i = 0; i < pairs.size(); ++i)
            scene.set_pose(pairs[i].second, nudged(placements[i].pose_b, by, placements[i].b->solid.diagonal, random));
        const Keys after = by_key(scene.find_contacts(pairs));
        const auto of = [&](const Contact& c) -> Kept& {
            return found[(c.feature.kind == FeatureKind::edges ? 1u : 0u) + (c.is_speculative() ? 2u : 0u)];
        };
        for (const auto& [key, c] : before) of(c).changed += !after.contains(key);
        for (const auto& [key, c] : after) {
            const auto at = before.find(key);
            if (at == before.end()) {
                ++of(c).changed;
                continue;
            }
            const Placement& p = placements[c.body_a.slot / 2];
            const double jump =
                length(c.point() - at->second.point()) / std::min(p.a->solid.diagonal, p.b->solid.diagonal);
            Kept& kept = of(c);
            ++kept.kept;
            kept.jumps += jump > 0.01;
            kept.farthest = std::max(kept.farthest, jump);
        }
    }
    return found;
}

void print(const Features& found, double by) {
    constexpr const char* names[] = {"vertices", "edges", "vertices before they touch", "edges before they touch"};
    for (std::size_t i = 0; i < found.size(); ++i)
        std::printf("[ counts   ] moved by %g: %llu %s kept, %llu went or came, %llu jumped, the farthest by %.2g\n",
                    by, static_cast<unsigned long long>(found[i].kept), names[i],
                    static_cast<unsigned long long>(found[i].changed), static_cast<unsigned long long>(found[i].jumps),
                    found[i].farthest);
}

// Edges that lie along each other have no one point where they pass (docs/internals/edges.md): few of them may jump.
TEST(persistence, few_points_of_flush_edges_jump) {
    const Features found = move(60, 1e-6, true);
    print(found, 1e-6);
    EXPECT_EQ(found[0].jumps + found[2].jumps, 0u);
    EXPECT_LT(static_cast<double>(found[1].jumps), 0.006 * static_cast<double>(found[1].kept));
    EXPECT_GT(found[1].kept, 10000u);
}

TEST(persistence, contacts_stay_while_bodies_hardly_move) {
    for (const double by : {1e-6, 1e-5}) {
        const Features found = move(40, by);
        print(found, by);
        for (const Kept& k : found) {
            // A vertex that begins to touch gives its key to that, and its others have new ones.
            EXPECT_LE(static_cast<double>(k.changed), 6 + 100 * by * static_cast<double>(k.kept));
            EXPECT_EQ(k.jumps, 0u);
        }
        // A vertex goes with its body, whose diagonal may be many times that of the smaller one.
        EXPECT_LT(std::max(found[0].farthest, found[2].farthest), 20 * by);
        EXPECT_GT(found[0].kept, 20000u);
        EXPECT_GT(found[1].kept, 1000u);
        EXPECT_GT(found[2].kept, 400u);
    }
}

} // namespace
