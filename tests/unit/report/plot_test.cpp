// SPDX-License-Identifier: Apache-2.0
#include <report/plot.h>

#include <gtest/gtest.h>

#include <cmath>

using namespace raycontact::report;

TEST(Plot, ReadableNumbers) {
    EXPECT_EQ(readable(0), "0");
    EXPECT_EQ(readable(12.3456), "12.35");
    EXPECT_EQ(readable(999), "999");
    EXPECT_EQ(readable(1000), "1\u202f000");
    EXPECT_EQ(readable(45123987), "45\u202f123\u202f987");
    EXPECT_EQ(readable(-1234), "-1\u202f234");
    EXPECT_EQ(readable(-123), "-123");
    EXPECT_EQ(readable(0.00012), "0.00012");
    EXPECT_EQ(readable(std::nan("")), "-");
}

TEST(Plot, TextIsMadeSafe) {
    EXPECT_EQ(escape_html("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
}

TEST(Plot, HasTitleUnitTicksAndOneLineASeries) {
    const Plot plot{"Time", "ms", "Wall clock.", {{"step", {1, 2, 3}}, {"narrow phase", {0.5, 1, 1.5}}}};
    const std::string html = plot_figure(plot, {0, 1, 2}, 1.0 / 60);
    for (const char* text :
         {"Time", ">ms<", "Wall clock.", "narrow phase", "16.67 ms", "class=\"line s0\"", "class=\"line s1\""})
        EXPECT_NE(html.find(text), std::string::npos) << text;
    EXPECT_EQ(html.find("spikes"), std::string::npos);
}

TEST(Plot, ASpikeIsCutAndSaid) {
    std::vector<double> values(600, 10), steps(600);
    for (std::size_t k = 0; k < 600; ++k) steps[k] = static_cast<double>(k);
    values[3] = 4321;
    const std::string html = plot_figure({"Time", "ms", "", {{"step", values}}}, steps, 0.1);
    EXPECT_NE(html.find("the largest is 4\u202f321 ms"), std::string::npos);
}

TEST(Plot, NothingToDrawIsNoFault) {
    for (const std::vector<double>& values : {std::vector<double>{}, {0.0}, {std::nan("")}, {0.0, 0.0}}) {
        const std::vector<double> steps(values.size(), 7);
        const Plot plot{"Pairs", "pairs", "", {{"pairs", values}}};
        const std::string html = plot_figure(plot, steps, 0.1);
        EXPECT_EQ(html.find("nan"), std::string::npos);
        EXPECT_EQ(html.find("inf"), std::string::npos);
        EXPECT_EQ(plot_data({plot}, steps).find("nan"), std::string::npos);
    }
}

TEST(Plot, DataCannotEndItsScript) {
    const std::string data = plot_data({{"t", "u", "", {{"</script>", {1}}}}}, {0});
    EXPECT_EQ(data.find('<'), std::string::npos);
}
