// SPDX-License-Identifier: Apache-2.0
#include <raycontact/clash.h>

#include "mesh/part_path.h"
#include "mesh/vector.h"

#include <algorithm>
#include <map>
#include <queue>
#include <utility>

namespace raycontact {

namespace {

AxisBox box_of(const Clash& clash) {
    return clash.box.value_or(AxisBox{least(clash.point_a, clash.point_b), most(clash.point_a, clash.point_b)});
}

ClashGroup group_of(std::string a, std::string b, std::vector<std::size_t> numbers, std::span<const Clash> clashes) {
    const AxisBox first = box_of(clashes[numbers[0]]);
    ClashGroup group{std::move(a), std::move(b), std::move(numbers), first};
    for (const std::size_t i : group.clashes) {
        const AxisBox box = box_of(clashes[i]);
        group.box = {least(group.box.low, box.low), most(group.box.high, box.high)};
    }
    return group;
}

/// By their first, and so their deepest, clash.
std::vector<ClashGroup> in_order(std::vector<ClashGroup> groups) {
    std::ranges::sort(groups, {}, [](const ClashGroup& group) { return group.clashes[0]; });
    return groups;
}

void check_parts(std::span<const AssemblyPart> parts, std::span<const Clash> clashes) {
    for (const Clash& clash : clashes)
        if (clash.a >= parts.size() || clash.b >= parts.size())
            throw InputError(
                "clash groups: a clash is of a part that is not there; give the parts that it was found in");
}

} // namespace

std::vector<ClashGroup> group_by_part(std::span<const AssemblyPart> parts, std::span<const Clash> clashes) {
    check_parts(parts, clashes);
    std::vector<std::vector<std::size_t>> of_part(parts.size());
    for (std::size_t i = 0; i < clashes.size(); ++i)
        for (const std::size_t part : {clashes[i].a, clashes[i].b}) of_part[part].push_back(i);
    std::vector<std::size_t> left(parts.size());
    // The most clashes first, then the lowest part; counts may be of before.
    using Entry = std::pair<std::size_t, std::size_t>;
    const auto later = [](const Entry& p, const Entry& q) {
        return std::pair(p.first, q.second) < std::pair(q.first, p.second);
    };
    std::priority_queue<Entry, std::vector<Entry>, decltype(later)> queue(later);
    for (std::size_t part = 0; part < parts.size(); ++part) {
        left[part] = of_part[part].size();
        if (left[part] > 0) queue.emplace(left[part], part);
    }
    std::vector<char> grouped(clashes.size(), 0);
    std::vector<ClashGroup> groups;
    while (!queue.empty()) {
        const auto [count, part] = queue.top();
        queue.pop();
        if (left[part] == 0) continue;
        if (left[part] < count) {
            queue.emplace(left[part], part);
            continue;
        }
        std::vector<std::size_t> numbers;
        std::size_t other = part;
        for (const std::size_t i : of_part[part]) {
            if (std::exchange(grouped[i], 1) != 0) continue;
            numbers.push_back(i);
            other = clashes[i].a == part ? clashes[i].b : clashes[i].a;
            --left[clashes[i].a];
            --left[clashes[i].b];
        }
        const std::string name = path_of(parts[part]),
                          only = numbers.size() == 1 ? path_of(parts[other]) : std::string();
        groups.push_back(group_of(name, only, std::move(numbers), clashes));
    }
    return in_order(std::move(groups));
}

std::vector<ClashGroup> group_by_assembly(std::span<const AssemblyPart> parts, std::span<const Clash> clashes,
                                          std::size_t level) {
    check_parts(parts, clashes);
    const auto assembly_of = [&](const AssemblyPart& part) {
        const std::size_t names = level > 0 ? level : part.under.size();
        return names == 0 || names > part.under.size() ? path_of(part) : joined(std::span(part.under).first(names));
    };
    std::map<std::pair<std::string, std::string>, std::vector<std::size_t>> found;
    for (std::size_t i = 0; i < clashes.size(); ++i) {
        std::pair names(assembly_of(parts[clashes[i].a]), assembly_of(parts[clashes[i].b]));
        if (names.second < names.first) std::swap(names.first, names.second);
        found[std::move(names)].push_back(i);
    }
    std::vector<ClashGroup> groups;
    groups.reserve(found.size());
    for (auto& [names, numbers] : found)
        groups.push_back(group_of(names.first, names.second, std::move(numbers), clashes));
    return in_order(std::move(groups));
}

} // namespace raycontact
