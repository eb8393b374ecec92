// SPDX-License-Identifier: Apache-2.0
#include "clash/selection.h"

#include <algorithm>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>

namespace raycontact::clash {

namespace {

/// "*" stands for any text, "?" for a character. Goes back to the last "*" alone.
bool matches(std::string_view pattern, std::string_view text) {
    constexpr std::size_t none = std::string_view::npos;
    std::size_t p = 0, t = 0, star = none, from = 0;
    while (t < text.size()) {
        if (p < pattern.size() && pattern[p] == '*') {
            star = p++;
            from = t;
        } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
            ++p;
            ++t;
        } else if (star != none) {
            p = star + 1;
            t = ++from;
        } else {
            return false;
        }
    }
    return pattern.find_first_not_of('*', p) == none;
}

/// The parts that patterns match, by their names, files, or the names of these without folders; with "/" by paths, too.
class Names {
public:
    explicit Names(std::span<const AssemblyPart> parts) {
        for (std::size_t i = 0; i < parts.size(); ++i) {
            paths_.push_back(path_of(parts[i]));
            add(parts[i].name, i);
            if (parts[i].file.empty()) continue;
            add(parts[i].file, i);
            add(std::filesystem::path(parts[i].file).filename().string(), i);
        }
    }

    std::vector<std::size_t> matched(const std::string& pattern, const std::string& what) const {
        std::vector<std::size_t> found;
        const auto add_all = [&](const std::vector<std::size_t>& parts) {
            found.insert(found.end(), parts.begin(), parts.end());
        };
        if (pattern.find_first_of("*?") == std::string::npos) {
            if (const auto at = parts_of_.find(pattern); at != parts_of_.end()) add_all(at->second);
        } else {
            for (const auto& [name, parts] : parts_of_)
                if (matches(pattern, name)) add_all(parts);
        }
        if (pattern.find('/') != std::string::npos)
            for (std::size_t i = 0; i < paths_.size(); ++i) // a path, or its end from some node on
                if (matches(pattern, paths_[i]) || matches("*/" + pattern, paths_[i])) found.push_back(i);
        if (found.empty())
            throw InputError(
                what + ": no part and no file is called \"" + pattern
                + "\"; give a name as clash prints it, or a pattern with * or ?, or with / as clash --tree has it");
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
        return found;
    }

private:
    void add(const std::string& name, std::size_t part) { parts_of_[name].push_back(part); }
    std::vector<std::string> paths_; ///< by part
    std::unordered_map<std::string, std::vector<std::size_t>> parts_of_;
};

constexpr std::uint32_t no_pair = UINT32_MAX;

/// The lowest that both have; no_pair: there is none.
std::uint32_t shared(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
    for (auto i = a.begin(), k = b.begin(); i != a.end() && k != b.end();) {
        if (*i == *k) return *i;
        ++(*i < *k ? i : k);
    }
    return no_pair;
}

using Matched = std::array<std::vector<std::vector<std::uint32_t>>, 2>;

/// The lowest pair of patterns that two parts match, whichever matches which.
std::uint32_t first_of(const Matched& matched, std::size_t a, std::size_t b) {
    if (matched[0].empty()) return no_pair;
    return std::min(shared(matched[0][a], matched[1][b]), shared(matched[0][b], matched[1][a]));
}

/// what: of a pair, for messages.
Matched matched_by(const Names& names, std::size_t parts, const auto& patterns, const auto& what) {
    Matched matched;
    if (patterns.empty()) return matched;
    for (std::size_t k = 0; k < 2; ++k) {
        matched[k].resize(parts);
        for (std::uint32_t i = 0; i < patterns.size(); ++i)
            for (const std::size_t part : names.matched(patterns[i][k], what(i))) matched[k][part].push_back(i);
    }
    return matched;
}

} // namespace

Selection::Selection(std::span<const AssemblyPart> parts, const ClashOptions& options, const char* word)
    : parts_(parts), parent_child_(options.exclude_parent_child), clearance_(options.clearance),
      clearances_(options.clearances) {
    if (options.against.empty() && options.exclude.empty() && clearances_.empty()) return;
    const Names names(parts);
    if (!options.against.empty()) {
        against_.resize(parts.size(), 0);
        for (const std::string& pattern : options.against)
            for (const std::size_t part : names.matched(pattern, word)) against_[part] = 1;
        if (std::ranges::all_of(against_, [](char matched) { return matched != 0; }))
            throw InputError(std::string(word)
                             + ": all parts match, so there is nothing to test them against; name fewer");
    }
    excluded_ = matched_by(names, parts.size(), options.exclude,
                           [](std::uint32_t i) { return "exclude, pair " + std::to_string(i + 1); });
    std::ranges::stable_sort(clearances_, std::greater(), &ClearanceOf::clearance);
    std::vector<std::array<std::string, 2>> patterns;
    for (const ClearanceOf& some : clearances_) patterns.push_back(some.parts);
    cleared_ = matched_by(names, parts.size(), patterns, [](std::uint32_t) { return std::string("clearance"); });
}

bool Selection::has(std::size_t a, std::size_t b) const {
    if (!against_.empty() && against_[a] == against_[b]) return false;
    if (parent_child_ && (parts_[a].parent == b || parts_[b].parent == a)) return false;
    return first_of(excluded_, a, b) == no_pair;
}

double Selection::clearance(std::size_t a, std::size_t b) const {
    const std::uint32_t first = first_of(cleared_, a, b);
    return first == no_pair ? clearance_ : std::max(clearance_, clearances_[first].clearance);
}

double Selection::largest_clearance() const {
    return clearances_.empty() ? clearance_ : std::max(clearance_, clearances_[0].clearance);
}

} // namespace raycontact::clash
