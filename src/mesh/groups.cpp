// SPDX-License-Identifier: Apache-2.0
#include "mesh/groups.h"

#include "mesh/adjacency.h"
#include "mesh/disjoint_sets.h"
#include "mesh/lowest_equal.h"
#include "mesh/odd_times.h"
#include "mesh/split.h"
#include "mesh/vector.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>

namespace raycontact {
namespace {

/// Joins the groups of each edge that has an odd number of sides in them.
void join_cut(const Mesh& mesh, std::span<const std::uint32_t> group_of, DisjointSets& sets) {
    std::vector<Vec3> places(mesh.vertices);
    for (Vec3& p : places) p = p + Vec3{}; // turns -0 into 0
    const std::vector<std::uint32_t> lowest = lowest_equal(places);
    std::vector<Triangle> welded;
    welded.reserve(mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles) welded.push_back({lowest[a], lowest[b], lowest[c]});
    std::vector<std::uint32_t> open;
    for_each_edge(sorted_half_edges(welded), [&](std::span<const HalfEdge> sides) {
        open.clear();
        for (const HalfEdge& side : sides) open.push_back(group_of[side.triangle()]);
        keep_odd_times(open);
        for (const std::uint32_t group : open) sets.join(open[0], group);
    });
}

template <class Names>
std::string in_list(const Names& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "'" : ", '") + name + "'";
    return text;
}

} // namespace

void Groups::begin(std::string name, std::size_t first) {
    if (runs_.empty() || runs_.back().first != name) runs_.emplace_back(std::move(name), first);
}

std::size_t Groups::names(std::size_t triangles) const {
    std::set<std::string_view> different;
    for (std::size_t run = 0; run < runs_.size(); ++run)
        if (runs_[run].second < (run + 1 < runs_.size() ? runs_[run + 1].second : triangles))
            different.insert(runs_[run].first);
    return different.size();
}

std::vector<AssemblyPart> Groups::parts(Mesh&& mesh, std::vector<std::string>& notes) const {
    notes.insert(notes.end(), mesh.repairs.begin(), mesh.repairs.end());
    // Numbers of the names by their first triangles.
    std::vector<std::string> names;
    std::map<std::string_view, std::uint32_t> numbers;
    std::vector<std::uint32_t> group_of(mesh.triangles.size(), 0);
    const auto begin = [&](std::size_t run) { return run < runs_.size() ? runs_[run].second : mesh.triangles.size(); };
    const auto number_of = [&](std::string_view name) {
        const auto [known, is_new] = numbers.emplace(name, static_cast<std::uint32_t>(names.size()));
        if (is_new) names.emplace_back(name);
        return known->second;
    };
    if (begin(0) > 0) number_of(unnamed);
    for (std::size_t run = 0; run < runs_.size(); ++run) {
        if (begin(run) == begin(run + 1)) continue;
        const std::uint32_t number = number_of(runs_[run].first);
        std::fill(group_of.begin() + static_cast<std::ptrdiff_t>(begin(run)),
                  group_of.begin() + static_cast<std::ptrdiff_t>(begin(run + 1)), number);
    }
    std::set<std::string> empty;
    for (const auto& run : runs_)
        if (run.first != unnamed && !numbers.contains(run.first)) empty.insert(run.first);
    if (!empty.empty()) notes.push_back("left out what has no triangles: " + in_list(empty));

    DisjointSets sets;
    sets.reset(names.size());
    if (names.size() > 1) join_cut(mesh, group_of, sets);
    std::vector<std::vector<std::string>> joined(names.size()); // names of each set, at its lowest number
    for (std::uint32_t g = 0; g < names.size(); ++g) joined[sets.of(g)].push_back(names[g]);
    const auto sets_left = std::ranges::count_if(joined, [](const auto& list) { return !list.empty(); });
    if (sets_left > 1)
        for (const auto& list : joined)
            if (list.size() > 1) notes.push_back("joined patches of one surface to a part: " + in_list(list));
    if (sets_left < 2) {
        std::string name = mesh.name;
        return {{std::move(name), std::make_shared<const Mesh>(std::move(mesh)), {}}};
    }

    for (std::uint32_t& g : group_of) g = sets.of(g);
    std::vector<AssemblyPart> parts;
    std::vector<Mesh> meshes = split_mesh(mesh, group_of, names.size());
    for (std::uint32_t g = 0; g < names.size(); ++g) {
        if (joined[g].empty()) continue;
        meshes[g].name = names[g];
        if (joined[g].size() > 1) meshes[g].name += " and " + std::to_string(joined[g].size() - 1) + " more";
        parts.push_back({meshes[g].name, std::make_shared<const Mesh>(std::move(meshes[g])), {}});
    }
    return parts;
}

} // namespace raycontact
