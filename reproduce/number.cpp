// SPDX-License-Identifier: Apache-2.0
#include <reproduce/number.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <stdexcept>
#include <utility>

namespace raycontact::reproduce {

namespace {

void check(const std::string& id, double ours) {
    if (!std::isfinite(ours)) throw std::logic_error(id + ": our figure is not a finite number; report this");
}

} // namespace

std::string_view to_string(Verdict verdict) {
    constexpr std::string_view words[] = {"passed", "reached", "missed", "not comparable"};
    return words[static_cast<std::size_t>(verdict)];
}

Verdict verdict_of(double paper, double ours, Better better) {
    check("verdict", ours);
    constexpr double printed = 0.005, near = 0.05; // the paper rounds its tables to two digits
    if (std::fabs(ours - paper) < printed) return Verdict::reached;
    if (better == Better::lower && ours < paper) return Verdict::passed;
    if (better == Better::higher && ours > paper) return Verdict::passed;
    return std::fabs(ours - paper) <= near * std::fabs(paper) * (1 + 1e-9) ? Verdict::reached : Verdict::missed;
}

Number compared(std::string id, double paper, double ours, std::string unit, Better better, std::string why) {
    check(id, ours);
    return {std::move(id), paper, ours, std::move(unit), verdict_of(paper, ours, better), std::move(why)};
}

Number not_comparable(std::string id, double paper, double ours, std::string unit, std::string why) {
    check(id, ours);
    return {std::move(id), paper, ours, std::move(unit), Verdict::not_comparable, std::move(why)};
}

nlohmann::ordered_json to_json(const std::vector<Number>& numbers) {
    auto list = nlohmann::ordered_json::array();
    for (const Number& n : numbers)
        list.push_back({{"id", n.id},
                        {"paper", n.paper},
                        {"ours", n.ours},
                        {"unit", n.unit},
                        {"verdict", to_string(n.verdict)},
                        {"why", n.why}});
    return list;
}

} // namespace raycontact::reproduce
