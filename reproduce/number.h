// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace raycontact::reproduce {

/// What counts as better than the paper.
enum class Better {
    lower,
    higher,
    neither, ///< a size of the scene, such as its pairs: equal or not
};

enum class Verdict { passed, reached, missed, not_comparable };

/// "passed", "reached", "missed", "not comparable".
std::string_view to_string(Verdict verdict);

/// passed: better than the paper; reached: within 5 % of its figure, or equal to the two digits that it prints; else
/// missed. Throws std::logic_error for a figure that is not finite.
Verdict verdict_of(double paper, double ours, Better better);

/// A number that the paper states, and ours.
struct Number {
    std::string id;
    double paper = 0, ours = 0;
    std::string unit;
    Verdict verdict = Verdict::missed;
    std::string why; ///< how ours was measured, and what differs
};

/// With the verdict by verdict_of.
Number compared(std::string id, double paper, double ours, std::string unit, Better better, std::string why);
/// Of what the paper leaves undefined or this machine cannot show. Throws std::logic_error unless `ours` is finite.
Number not_comparable(std::string id, double paper, double ours, std::string unit, std::string why);

/// The list of results.json.
nlohmann::ordered_json to_json(const std::vector<Number>& numbers);

} // namespace raycontact::reproduce
