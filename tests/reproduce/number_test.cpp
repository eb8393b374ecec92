// SPDX-License-Identifier: Apache-2.0
#include <reproduce/number.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <limits>
#include <stdexcept>

namespace raycontact::reproduce {
namespace {

TEST(Verdict, BetterIsPassedNearIsReachedElseMissed) {
    EXPECT_EQ(verdict_of(91, 91.1, Better::higher), Verdict::passed);
    EXPECT_EQ(verdict_of(91, 91, Better::higher), Verdict::reached);
    EXPECT_EQ(verdict_of(91, 86.5, Better::higher), Verdict::reached);
    EXPECT_EQ(verdict_of(91, 86.4, Better::higher), Verdict::missed);
    EXPECT_EQ(verdict_of(22, 21.9, Better::lower), Verdict::passed);
    EXPECT_EQ(verdict_of(22, 23.1, Better::lower), Verdict::reached);
    EXPECT_EQ(verdict_of(22, 23.2, Better::lower), Verdict::missed);
    EXPECT_EQ(verdict_of(7300, 7600, Better::neither), Verdict::reached);
    EXPECT_EQ(verdict_of(7300, 8000, Better::neither), Verdict::missed);
    EXPECT_EQ(verdict_of(7300, 6000, Better::neither), Verdict::missed);
}

TEST(Verdict, ZeroAsPrintedIsReached) {
    EXPECT_EQ(verdict_of(0, 0.004, Better::lower), Verdict::reached);
    EXPECT_EQ(verdict_of(0, 0.006, Better::lower), Verdict::missed);
}

TEST(Verdict, OursMustBeFinite) {
    EXPECT_THROW(compared("x", 1, std::numeric_limits<double>::quiet_NaN(), "", Better::higher, ""), std::logic_error);
    EXPECT_THROW(not_comparable("x", 1, std::numeric_limits<double>::infinity(), "", ""), std::logic_error);
}

TEST(Number, AsResultsHaveIt) {
    const auto list = to_json({compared("lga13", 33, 40, "times", Better::higher, "so"),
                               not_comparable("table1.sphere.ray", 3.97, 5, "%", "its sphere")});
    ASSERT_EQ(list.size(), 2u);
    EXPECT_EQ(list[0].dump(),
              R"({"id":"lga13","paper":33.0,"ours":40.0,"unit":"times","verdict":"passed","why":"so"})");
    EXPECT_EQ(list[1]["verdict"], "not comparable");
}

} // namespace
} // namespace raycontact::reproduce
