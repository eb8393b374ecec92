// SPDX-License-Identifier: Apache-2.0
#include "cli/suggest.h"

#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

namespace {

/// Characters to put in, leave out or change.
std::size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i + 1);
        for (std::size_t k = 0; k < b.size(); ++k) {
            const std::size_t change = diagonal + (a[i] == b[k] ? 0 : 1);
            diagonal = row[k + 1];
            row[k + 1] = std::min({change, diagonal + 1, row[k] + 1});
        }
    }
    return row[b.size()];
}

/// Of the names that a person may have meant the nearest; empty: none is near.
std::string nearest_to(const std::string& given, const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const CLI::App* sub : command.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(sub->get_name());
    const std::string word = given.substr(0, given.find('='));
    std::string best;
    std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
    for (const std::string& name : names) {
        const std::size_t away = distance(word, name);
        if (away >= least) continue;
        least = away;
        best = name;
    }
    return best;
}

} // namespace

std::string what_was_not_expected(const CLI::App& app) {
    const CLI::App* command = &app;
    while (command->remaining(false).empty()) {
        const auto chosen = command->get_subcommands();
        if (chosen.empty()) return "an argument was not expected";
        command = chosen.back();
    }
    const std::vector<std::string> given = command->remaining(false);
    std::string text = given.size() > 1 ? "these arguments were not expected:" : "this argument was not expected:";
    for (const std::string& one : given) {
        text += ' ';
        text += one;
    }
    for (const std::string& one : given) {
        const std::string near = nearest_to(one, *command);
        if (!near.empty()) return text.append("; did you mean ").append(near).append("?");
    }
    return text;
}
