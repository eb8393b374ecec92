// SPDX-License-Identifier: Apache-2.0
// The meshes that `samples` writes are what it says of them.
#include "program.h"

#include <gtest/gtest.h>

using nlohmann::json;

namespace {

TEST(Samples, TheNutsAloneAreInEachOther) {
    const TemporaryFolder folder;
    ASSERT_EQ(run_program({"samples", "--out", "."}, folder.path()).status, 0);
    const auto result = run_program({"clash", "assembly.glb", "--json"}, folder.path());
    ASSERT_EQ(result.status, 0) << result.err;
    const json clash = json::parse(result.out); // throws where there is another line
    EXPECT_EQ(clash.at("a"), "nut");
    EXPECT_EQ(clash.at("b"), "lock nut");
    EXPECT_NEAR(clash.at("depth").get<double>(), 0.00075, 1e-6);
}

TEST(Samples, TheBoltAndItsNutAreApart) {
    const TemporaryFolder folder;
    ASSERT_EQ(run_program({"samples", "--out", "."}, folder.path()).status, 0);
    const auto result = run_program({"collide", "bolt.obj", "nut.obj", "--json"}, folder.path());
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(json::parse(result.out).at("intersecting"), false);
}

} // namespace
