// SPDX-License-Identifier: Apache-2.0
// The question that everyone is asked: is it the same each time, and does it hold what it promises?
#include <bench/peers/contest.h>
#include <bench/peers/growth.h>
#include <bench/peers/motion.h>
#include <bench/peers/reference.h>
#include <scenes/models/model.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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
    const auto scene = make_scene(work, one_thread(Method::standard));
    std::vector<std::size_t> contacts;
    for (const WorkStep& step : work.steps) {
        place(*scene, step);
        contacts.push_back(scene->find_contacts(step.pairs).size());
        for (const Pair& pair : step.pairs) {
            EXPECT_EQ(pair.first.slot % 2, 0u);
            EXPECT_EQ(pair.second.slot, pair.first.slot + 1) << "a pair sees another";
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

TEST(PeersContest, EveryMethodIsHeldAgainstStandard) {
    const Work work = some_pairs();
    const std::vector<std::string> methods{"bvh", "basic", "iterative", "iterative-basic", "predictive", "certified"};
    const std::vector<Result> results = contest(work, only(methods), 1, [](const std::string&) {});
    ASSERT_EQ(results.size(), methods.size());
    const Result& bvh = of(results, "bvh");
    for (const Result& r : results) {
        ASSERT_TRUE(r.wrong.has_value()) << r.peer;
        EXPECT_TRUE(r.agrees) << r.peer;
        EXPECT_EQ(r.contacts, r.sums.contacts) << r.peer; // checked and timed runs did the same
        EXPECT_EQ(r.contacts + r.wrong->missed, r.wrong->contacts_compared + r.wrong->invented) << r.peer;
        EXPECT_GT(r.method_ratios[0], 0) << r.peer;
    }
    for (const char* exact : {"bvh", "basic", "certified"}) EXPECT_EQ(of(results, exact).wrong->total(), 0u) << exact;
    EXPECT_EQ(of(results, "certified").hash, bvh.hash);
    EXPECT_EQ(bvh.wrong->contacts_compared, bvh.contacts);
    EXPECT_EQ(bvh.wrong->rays_compared, bvh.rays);
    // Both casters give the same bits, wrong ones too.
    EXPECT_EQ(of(results, "iterative").hash, of(results, "iterative-basic").hash);
    // The state from step to step is at work: iterative follows rays, certified leaves rays out.
    EXPECT_EQ(of(results, "iterative").steps, 20u);
    EXPECT_GT(of(results, "iterative").sums.details.walks, 0u);
    EXPECT_GT(of(results, "predictive").sums.pair_bytes, 0u);
    EXPECT_LT(of(results, "certified").rays, bvh.rays);
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
        for (std::uint32_t body = 1; body < step.poses.size(); body += 2) step.poses[body].translation.z += 2;
    for (const Result& r : contest(apart, only(names), 1, [](const std::string&) {}))
        EXPECT_EQ(r.contacts, 0u) << r.peer;
}

TEST(PeersWork, StepsOfPairsFollowEachOther) {
    ApproachOptions options;
    options.pairs = 2; // as many steps as usual
    const Pace pairs = pace(approaching_pairs("some", Shape::make(scenes::scene_model("knot", 300).mesh), "", options));
    EXPECT_GT(pairs.median, 0.002);
    EXPECT_LT(pairs.most, 0.015);
}

TEST(PeersWork, RollingPairsKeepTheirContactsAndTheirPace) {
    RollingOptions options;
    options.pairs = 2;
    options.steps = 12;
    options.displacement = 0.01;
    for (const std::uint32_t triangles : {1000u, 4000u}) {
        const Work work =
            rolling_pairs("rolling", Shape::make(scenes::scene_model("sphere", triangles).mesh), "", options);
        EXPECT_NEAR(pace(work).median, 0.01, 0.002);
        const auto scene = make_scene(work, one_thread(Method::standard));
        double contacts = 0;
        for (const WorkStep& step : work.steps) {
            place(*scene, step);
            contacts += static_cast<double>(scene->find_contacts(step.pairs).size());
        }
        EXPECT_NEAR(contacts / static_cast<double>(work.pair_steps()), options.contacts, 0.5) << triangles;
    }
    options.displacement = 0;
    const Work still = rolling_pairs("rolling", Shape::make(scenes::scene_model("sphere", 1000).mesh), "", options);
    EXPECT_EQ(pace(still).most, 0);
}

TEST(Growth, RaysGrowWithTriangles) {
    GrowthOptions options;
    options.parts = {"triangles", "contacts", "creeping", "still"};
    options.bodies = 0;
    options.triangles = 3160;
    options.pairs = 2;
    const std::vector<GrowthRow> rows = growth(options, [](const std::string&) {});
    ASSERT_EQ(rows.size(), 3 * (4 + 3 * 2u));
    for (const GrowthRow& row : rows) {
        EXPECT_GT(row.contacts, 0);
        EXPECT_GT(row.us_per_pair, 0);
    }
    for (std::size_t i = 3; i < 12; i += 3) EXPECT_LT(rows[i - 3].rays, rows[i].rays);
    EXPECT_LT(1.5 * rows[6].contacts, rows[9].contacts);
    // Rolling pairs have more rays, too, but the contacts stay.
    EXPECT_EQ(rows[12].part, "contacts");
    EXPECT_LT(rows[12].rays, rows[15].rays);
    EXPECT_NEAR(rows[12].contacts, rows[15].contacts, 0.1 * rows[12].contacts);
    EXPECT_EQ(rows[20].part, "creeping");
    EXPECT_NEAR(rows[20].pace, 0.0002, 2e-6);
    EXPECT_GT(rows[20].rays, 0);
    EXPECT_EQ(rows[26].part, "still");
    EXPECT_EQ(rows[26].method, Method::certified);
    // Certified finds what standard finds.
    for (std::size_t i = 0; i < rows.size(); i += 3) EXPECT_EQ(rows[i].contacts, rows[i + 2].contacts);
    EXPECT_EQ(slopes(rows).size(), 12u);
}

TEST(Growth, SlopeOfAPower) {
    std::vector<GrowthRow> rows;
    for (const double size : {64.0, 128.0, 256.0, 512.0}) {
        GrowthRow& row = rows.emplace_back();
        row.part = "bodies";
        row.size = size;
        row.us_per_pair = 3 * size * std::sqrt(size);
    }
    const std::vector<Slope> all = slopes(rows);
    ASSERT_EQ(all.size(), 1u);
    EXPECT_NEAR(all[0].power, 1.5, 1e-9);
    EXPECT_EQ(all[0].from, 64);
    EXPECT_EQ(all[0].to, 512);
}
