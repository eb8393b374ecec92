// SPDX-License-Identifier: Apache-2.0
#include "cli/clash_clearance.h"

#include "cli/length_unit.h"
#include "cli/number_option.h"

#include <algorithm>

namespace raycontact {

namespace {

double length_of(const std::string& text, const std::string& word, const std::string& unit) {
    const std::size_t end = std::min(text.find_last_of("0123456789.") + 1, text.size());
    const std::string own = text.substr(end);
    const auto number = read_number<double>(text.substr(0, end));
    const LengthUnit* const named = length_unit(own);
    constexpr double most = 1e9;
    if (number && !own.empty() && !named)
        throw InputError("--clearance: \"" + word + "\": \"" + own + "\" is no unit; give m, mm, cm or in");
    if (!number || !(*number >= 0 && *number <= most))
        throw InputError("--clearance: \"" + word
                         + "\" does not begin with a length from 0 to 1e9; give LENGTH, "
                           "LENGTH:SET or LENGTH:SET:SET, as 25mm:pipe*");
    if (!named) return *number;
    const LengthUnit* const files = length_unit(unit);
    if (!files)
        throw InputError("--clearance: \"" + word
                         + "\" has a unit, and nothing says which one the files have; give --unit m, mm, cm or in");
    return *number * (named->metres / files->metres);
}

} // namespace

void set_clearances(const std::vector<std::string>& given, const std::string& unit, ClashOptions& how) {
    for (const std::string& word : given) {
        const std::size_t first = std::min(word.find(':'), word.size());
        const double length = length_of(word.substr(0, first), word, unit);
        if (first == word.size()) {
            how.clearance = std::max(how.clearance, length);
            continue;
        }
        const std::size_t second = std::min(word.find(':', first + 1), word.size());
        ClearanceOf some{length, {word.substr(first + 1, second - first - 1), "*"}};
        if (second < word.size()) some.parts[1] = word.substr(second + 1);
        if (some.parts[0].empty() || some.parts[1].empty())
            throw InputError("--clearance: \"" + word
                             + "\" has a pattern that is empty; give LENGTH:SET or "
                               "LENGTH:SET:SET");
        how.clearances.push_back(some);
    }
}

} // namespace raycontact
