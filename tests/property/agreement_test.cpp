// SPDX-License-Identifier: Apache-2.0
// Both casters against the brute-force reference, over random overlapping poses.
#include "property/shapes.h"
#include "reference/compare.h"
#include "reference/vector.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <tuple>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

Settings with(Caster caster) {
    Settings settings;
    settings.caster = caster;
    return settings;
}

auto key(const Contact& c) {
    return std::tuple(c.body_a, c.body_b, c.vertex_body, c.vertex);
}

struct Counts {
    Comparison sum;
    std::uint64_t pairs_touching = 0, swapped = 0, rays_of_library = 0, side_tests = 0;
};

// Swapping a and b may change nothing but the order of the two directions and the sign of the normals.
void expect_flipped(std::span<const Contact> one, std::span<const Contact> two, Counts& counts) {
    ASSERT_EQ(one.size(), two.size());
    std::size_t of_a = 0;
    while (of_a < one.size() && one[of_a].vertex_body == VertexBody::a) ++of_a;
    for (std::size_t i = 0; i < one.size(); ++i) {
        const Contact& c = one[i];
        const Contact& d = two[i < of_a ? i + (one.size() - of_a) : i - of_a];
        ASSERT_NE(c.vertex_body, d.vertex_body);
        ASSERT_EQ(c.vertex, d.vertex);
        ASSERT_EQ(c.triangle, d.triangle);
        ASSERT_EQ(c.point, d.point);
        for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(c.normal[k], -d.normal[k]);
        ASSERT_EQ(c.depth, d.depth);
        ASSERT_EQ(c.ray_length, d.ray_length);
        ++counts.swapped;
    }
}

void run(const std::vector<const Subject*>& subjects, std::size_t poses, std::uint64_t seed, Counts& counts) {
    constexpr std::size_t batch = 100;
    Random random(seed);
    for (std::size_t done = 0; done < poses; done += batch) {
        std::vector<Placement> placements;
        for (std::size_t i = 0; i < batch; ++i) placements.push_back(random_placement(subjects, random));
        Scene bvh(with(Caster::bvh));
        Scene basic(with(Caster::basic));
        Scene swapped(with(Caster::bvh));
        const auto contacts = bvh.step(add_all(bvh, placements));
        const auto of_basic = basic.step(add_all(basic, placements));
        const auto of_swapped = swapped.step(add_all(swapped, placements, true));
        ASSERT_TRUE(same_bits(contacts, of_basic)) << "the casters differ, poses from " << done << ", seed " << seed;
        ASSERT_EQ(bvh.stats().rays, basic.stats().rays);
        ASSERT_EQ(bvh.stats().contacts, contacts.size());
        counts.rays_of_library += bvh.stats().rays;
        counts.side_tests += bvh.stats().side_tests;
        for (std::size_t i = 1; i < contacts.size(); ++i) ASSERT_LT(key(contacts[i - 1]), key(contacts[i]));

        const auto parts = by_pair(contacts, batch);
        const auto swapped_parts = by_pair(of_swapped, batch);
        std::size_t seen = 0;
        for (std::size_t i = 0; i < batch; ++i) {
            const Placement& p = placements[i];
            compare(p.a->solid, p.pose_a, p.b->solid, p.pose_b, parts[i], counts.sum);
            expect_flipped(parts[i], swapped_parts[i], counts);
            counts.pairs_touching += !parts[i].empty();
            seen += parts[i].size();
        }
        ASSERT_EQ(seen, contacts.size()); // none belongs to a pair that was not asked for
    }
}

void report(const Counts& c) {
    std::printf("[ counts   ] %s\n[ counts   ] %llu pairs with contacts, %llu contacts the same when swapped, library "
                "cast %llu rays, %llu decided by side\n",
                c.sum.summary().c_str(), static_cast<unsigned long long>(c.pairs_touching),
                static_cast<unsigned long long>(c.swapped), static_cast<unsigned long long>(c.rays_of_library),
                static_cast<unsigned long long>(c.side_tests));
    EXPECT_EQ(c.sum.wrong, 0u);
    EXPECT_LT(static_cast<double>(c.sum.excused), 0.001 * static_cast<double>(c.sum.rays));
    EXPECT_GE(c.pairs_touching, c.sum.pairs / 2);
    // The same vertices inside the bounds, rounding apart.
    EXPECT_NEAR(static_cast<double>(c.rays_of_library), static_cast<double>(c.sum.rays),
                0.001 * static_cast<double>(c.sum.rays));
}

TEST(agreement, closed_meshes) {
    Counts counts;
    run(pointers(closed_subjects()), 16000, 20130101, counts);
    report(counts);
    EXPECT_GE(counts.sum.pairs, 16000u);
    EXPECT_GE(counts.sum.agreed, 250000u);
}

TEST(agreement, open_meshes_among_closed_ones) {
    auto subjects = pointers(open_subjects());
    for (const Subject& s : closed_subjects())
        if (s.solid.triangles.size() < 900) subjects.push_back(&s);
    Counts counts;
    run(subjects, 4000, 20130202, counts);
    report(counts);
    EXPECT_GE(counts.sum.pairs, 4000u);
    EXPECT_GE(counts.sum.agreed, 25000u);
}

} // namespace
