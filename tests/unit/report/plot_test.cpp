// SPDX-License-Identifier: Apache-2.0
#include <report/plot.h>
#include <report/svg.h>

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

namespace {

Line over_steps_from(double first, const std::string& name, const std::vector<double>& values) {
    Line line{name, {}};
    for (std::size_t k = 0; k < values.size(); ++k) line.points.emplace_back(first + static_cast<double>(k), values[k]);
    return line;
}

std::size_t count(const std::string& text, const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++found;
    return found;
}

} // namespace

TEST(Plot, HasTitleUnitTicksAndOneLineASeries) {
    const Plot plot{"Time",
                    "ms",
                    "Wall clock.",
                    {over_steps_from(0, "step", {1, 2, 3}), over_steps_from(0, "narrow phase", {0.5, 1, 1.5})},
                    over_steps(1.0 / 60)};
    const std::string html = plot_figure(plot);
    for (const char* text :
         {"Time", ">ms<", "Wall clock.", "narrow phase", "16.67 ms", "class=\"line s0\"", "class=\"line s1\""})
        EXPECT_NE(html.find(text), std::string::npos) << text;
    EXPECT_EQ(html.find("spikes"), std::string::npos);
    EXPECT_EQ(plot_data({plot}), R"({"plots":[{"series":[{"name":"step","values":[1.0,2.0,3.0]},)"
                                 R"({"name":"narrow phase","values":[0.5,1.0,1.5]}],"top":3.0,"unit":"ms"}],)"
                                 R"("steps":[0.0,1.0,2.0]})");
}

TEST(Plot, ASpikeIsCutAndSaid) {
    std::vector<double> values(600, 10);
    values[3] = 4321;
    const std::string html = plot_figure({"Time", "ms", "", {over_steps_from(0, "step", values)}});
    EXPECT_NE(html.find("the largest is 4\u202f321 ms"), std::string::npos);
}

TEST(Plot, NothingToDrawIsNoFault) {
    for (const std::vector<double>& values : {std::vector<double>{}, {0.0}, {std::nan("")}, {0.0, 0.0}})
        for (const bool logarithmic : {false, true}) {
            const Plot plot{"Pairs", "pairs", "", {over_steps_from(7, "pairs", values)}, "step", logarithmic};
            for (const std::string& text : {plot_figure(plot), plot_svg({plot}), plot_data({plot})}) {
                EXPECT_EQ(text.find("nan"), std::string::npos);
                EXPECT_EQ(text.find("inf"), std::string::npos);
            }
        }
    EXPECT_EQ(count(plot_svg({}), "<path"), 0u);
    EXPECT_EQ(count(bar_chart("Time", "us", {{"none", {{"a", 0}}}}), "class=\"k"), 0u);
}

TEST(Plot, LogarithmicAxesHoldWholePowersOfTen) {
    const Axis axis = logarithmic_axis({0, std::nan(""), 0.02, 30});
    EXPECT_EQ(axis.ticks.size(), 5u); // 0.01 to 100
    EXPECT_DOUBLE_EQ(axis.at(0.01), 0);
    EXPECT_NEAR(axis.at(1), 0.5, 1e-12);
    EXPECT_DOUBLE_EQ(axis.at(100), 1);
    const Axis single = logarithmic_axis({10});
    EXPECT_DOUBLE_EQ(single.first, 10);
    EXPECT_DOUBLE_EQ(single.last, 100);
}

TEST(Plot, ALineIsInterruptedWhereThereIsNoPoint) {
    Line line{"wrong", {{1, 5}, {2, 6}, {3, 0}, {4, 7}, {5, 8}}};
    Line chosen{"chosen", {{1, 6}, {5, 6}}, 0, true};
    const std::string svg = plot_svg({{"Wrong", "rays", "", {line, chosen}, "steps", true}});
    EXPECT_EQ(count(svg, "<circle class=\"k0\""), 4u);
    EXPECT_EQ(count(svg, "class=\"line s0\""), 2u); // the dashed one has the same colour
    EXPECT_EQ(count(svg, "stroke-dasharray"), 1u);
    const std::size_t begin = svg.find("class=\"line s0\" d=");
    EXPECT_EQ(count(svg.substr(begin, svg.find("/>", begin) - begin), "M"), 2u);
}

TEST(Plot, DataCannotEndItsScript) {
    const std::string data = plot_data({{"t", "u", "", {over_steps_from(0, "</script>", {1})}}});
    EXPECT_EQ(data.find('<'), std::string::npos);
}

TEST(Bars, AreLabelledAndANameKeepsItsColour) {
    const std::string svg =
        bar_chart("Time", "us", {{"one work", {{"ours", 1}, {"theirs", 30}}}, {"another", {{"theirs", 20}}}});
    for (const char* text : {"Time", ">us<", "one work", "another", ">ours<", ">theirs<", ">20<"})
        EXPECT_NE(svg.find(text), std::string::npos) << text;
    EXPECT_EQ(count(svg, "<rect class=\"k0\""), 1u);
    EXPECT_EQ(count(svg, "<rect class=\"k1\""), 2u);
}
