// SPDX-License-Identifier: Apache-2.0
// The question that everyone is asked: is it the same each time, and does it hold what it promises?
#include <bench/peers/contest.h>
#include <bench/peers/growth.h>
#include <scenes/models/model.h>

#include <gtest/gtest.h>

#include <algorithm>

using namespace raycontact;
using namespace raycontact::bench;

namespace {

Work some_pairs(std::uint32_t triangles = 300) {
    ApproachOptions options;
    options.pairs = 4;
    options.steps = 20;
    return approaching_pairs("some", Shape::make(scenes::scene_model("knot", triangles).mesh), "a knot", options);
}

std::vector<Entrant> only(std::vector<std::string> names) {
    std::vector<Entrant> some;
    for (Entrant& entrant : entrants())
        if (std::find(names.begin(), names.end(), entrant.name) != names.end()) some.push_back(std::move(entrant));
    return some;
}

const Result& of(const std::vector<Result>& results, const std::string& peer) {
    return *std::find_if(results.begin(), results.end(), [&](const Result& r) { return r.peer == peer; });
}

} // namespace

TEST(PeersWork, PairsStartApartAndEndInContact) {
    const Work work = some_pairs();
    ASSERT_EQ(work.steps.size(), 20u);
    const auto scene = make_scene(work, Caster::bvh);
    std::vector<std::size_t> contacts;
    for (const WorkStep& step : work.steps) {
        for (BodyId body = 0; body < step.poses.size(); ++body) scene->set_pose(body, step.poses[body]);
        contacts.push_back(scene->step(step.pairs).size());
        for (const Pair& pair : step.pairs) {
            EXPECT_EQ(pair.first % 2, 0u);
            EXPECT_EQ(pair.second, pair.first + 1) << "a pair sees another";
        }
    }
    EXPECT_EQ(contacts.front(), 0u);
    EXPECT_GT(contacts.back(), 4u);
    EXPECT_EQ(work.steps.back().pairs.size(), 4u);
}

TEST(PeersWork, SameWorkEachTime) {
    const Work one = some_pairs(), two = some_pairs();
    for (std::size_t k = 0; k < one.steps.size(); ++k) {
        EXPECT_EQ(one.steps[k].poses, two.steps[k].poses);
        EXPECT_EQ(one.steps[k].pairs, two.steps[k].pairs);
    }
}

TEST(PeersContest, OursAgreeAndEmbreeFindsTheSameContacts) {
    const Work work = some_pairs();
    const std::vector<Result> results =
        contest(work, only({"bvh", "basic", "embree", "rays", "embree-rays"}), 2, [](const std::string&) {});
    ASSERT_EQ(results.size(), 5u);
    const Result& bvh = of(results, "bvh");
    EXPECT_TRUE(of(results, "basic").agrees);
    EXPECT_EQ(of(results, "basic").steps, 2u); // every tenth
    EXPECT_EQ(bvh.pair_steps, work.pair_steps());
    EXPECT_GT(bvh.contacts, 0u);
    EXPECT_EQ(bvh.hash.size(), 16u);
    EXPECT_GT(bvh.us, 0);
    EXPECT_EQ(bvh.ratio, 1);
    // The same rule in other hands: the same rays, and the same contacts but for rays that graze.
    for (const char* peer : {"embree", "embree-rays", "rays"}) {
        EXPECT_EQ(of(results, peer).rays, bvh.rays) << peer;
        EXPECT_NEAR(double(of(results, peer).contacts), double(bvh.contacts), 1 + 0.002 * double(bvh.rays)) << peer;
    }
    EXPECT_NEAR(of(results, "embree").depth_sum, bvh.depth_sum, 1e-3 * bvh.depth_sum);
}

TEST(PeersContest, PeersMeetWhereWeDo) {
    const Work work = some_pairs();
    std::vector<std::string> names{"bvh", "gimpact", "fcl", "ode"};
    const std::vector<Result> results = contest(work, only(names), 1, [](const std::string&) {});
    ASSERT_GE(results.size(), 2u); // Bullet is always there
    for (const Result& r : results) {
        EXPECT_GT(r.contacts, 0u) << r.peer;
        EXPECT_GT(r.us, 0) << r.peer;
        EXPECT_EQ(r.pair_steps, work.pair_steps()) << r.peer;
    }
    // Apart, nobody finds anything; well apart, since the peers see edges meet before any vertex is inside.
    Work apart = work;
    for (WorkStep& step : apart.steps)
        for (BodyId body = 1; body < step.poses.size(); body += 2) step.poses[body].translation.z += 2;
    for (const Result& r : contest(apart, only(names), 1, [](const std::string&) {}))
        EXPECT_EQ(r.contacts, 0u) << r.peer;
}

TEST(Growth, RaysGrowWithTriangles) {
    GrowthOptions options;
    options.bodies = 0;
    options.triangles = 1000;
    options.pairs = 2;
    const std::vector<GrowthRow> rows = growth(options, [](const std::string&) {});
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_EQ(rows[2].size, 1000u);
    EXPECT_LT(rows[0].rays, rows[1].rays);
    EXPECT_LT(rows[1].rays, rows[2].rays);
    for (const GrowthRow& row : rows) {
        EXPECT_GT(row.contacts, 0);
        EXPECT_GT(row.us_per_pair, 0);
    }
}
