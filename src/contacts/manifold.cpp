// SPDX-License-Identifier: Apache-2.0
#include <raycontact/manifold.h>

#include "mesh/vector.h"
#include "shape/mesh_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace raycontact {

namespace {

constexpr std::size_t most_points = 4;
constexpr double patch_cosine = 0.8;
constexpr double like_normals = 0.98;
// Of points that are present, on a squared distance and on a depth.
constexpr double farther = 4, deeper = 1.1;

// The patch that suits a point best; their number when none does.
std::size_t suitable(const ManifoldPoint& point, double cosine, std::span<const ManifoldPatch> patches) {
    if (point.patch < patches.size()) return point.patch;
    std::size_t found = patches.size();
    for (std::size_t i = 0; i < patches.size(); ++i) {
        const Vec3 away = patches[i].centre - point.position;
        const double like = dot(patches[i].normal, point.normal);
        if (like < cosine || dot(away, away) > point.reach * point.reach) continue;
        if (found < patches.size() && like == cosine) continue;
        cosine = like;
        found = i;
    }
    return found;
}

// Squared, from the convex hull of at most three points.
double distance2_from_hull(const Vec3& p, std::span<const Vec3> hull) {
    const Vec3 off = p - (hull.size() == 1 ? hull[0] : nearest_point(p, hull[0], hull[1], hull.back()));
    return dot(off, off);
}

Vec3 middle_of(std::span<const ManifoldPoint> points, std::span<const std::uint32_t> patch) {
    Vec3 sum;
    for (const std::uint32_t i : patch) sum = sum + points[i].position;
    return (1.0 / double(patch.size())) * sum;
}

} // namespace

bool say_the_same(const ManifoldPoint& a, const ManifoldPoint& b) {
    const Vec3 away = a.position - b.position;
    const double place = std::min(a.place, b.place);
    return dot(away, away) <= place * place && dot(a.normal, b.normal) >= like_normals;
}

void join_patches(std::span<const ManifoldPoint> points, double cosine, std::vector<ManifoldPatch>& patches) {
    std::vector<std::pair<double, std::uint32_t>> order; // by their depths alone: points lie far apart in memory
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const double depth = points[i].depth;
        order.emplace_back(std::isnan(depth) ? std::numeric_limits<double>::infinity() : -depth, i);
    }
    std::ranges::sort(order);
    for (const auto& [_, i] : order) {
        const std::size_t home = suitable(points[i], cosine, patches);
        if (home == patches.size()) patches.push_back({points[i].normal, points[i].position, {}});
        patches[home].points.push_back(i);
    }
}

std::vector<std::uint32_t> choose_points(std::span<const ManifoldPoint> points, std::span<const std::uint32_t> patch) {
    if (patch.size() < 2) return {patch.begin(), patch.end()};
    const auto by_depth = [&](std::uint32_t i) {
        const double depth = points[i].depth;
        return points[i].present ? std::max(deeper * depth, depth / deeper) : depth;
    };
    const auto by_presence = [&](std::uint32_t i) { return std::pair(points[i].present, points[i].depth); };
    const std::uint32_t deepest = *std::ranges::max_element(patch, {}, by_depth);

    // The extremes first, whatever their depths: a body that rocks keeps them while now one is deepest, now another.
    std::vector<std::uint32_t> left(patch.begin(), patch.end()), chosen;
    std::vector<Vec3> hull{middle_of(points, patch)};
    const auto score = [&](std::uint32_t i) {
        const double away2 = distance2_from_hull(points[i].position, hull);
        return away2 > points[i].place * points[i].place ? (points[i].present ? farther : 1) * away2 : 0;
    };
    const auto take = [&](std::uint32_t taken) {
        chosen.push_back(taken);
        std::erase_if(left, [&](std::uint32_t i) { return i == taken || say_the_same(points[i], points[taken]); });
    };
    while (!left.empty() && chosen.size() < most_points) {
        const std::uint32_t farthest = *std::ranges::max_element(left, {}, score);
        if (!(score(farthest) > 0)) break;
        std::uint32_t speaker = farthest; // of those that say the same
        for (const std::uint32_t i : left)
            if (say_the_same(points[i], points[farthest]) && by_presence(i) > by_presence(speaker)) speaker = i;
        take(speaker);
        if (chosen.size() == 1) hull.clear(); // the middle is no point
        hull.push_back(points[speaker].position);
    }

    // Then the deepest, in place of what says the same, else of the extreme that the others miss least.
    auto gone = std::ranges::find_if(
        chosen, [&](std::uint32_t i) { return i == deepest || say_the_same(points[i], points[deepest]); });
    if (gone == chosen.end() && chosen.size() == most_points)
        gone = std::ranges::min_element(chosen, {}, [&](std::uint32_t i) {
            double least = std::numeric_limits<double>::infinity();
            for (const std::uint32_t without : chosen) {
                if (without == i) continue;
                hull.assign(1, points[deepest].position);
                for (const std::uint32_t other : chosen)
                    if (other != i && other != without) hull.push_back(points[other].position);
                least = std::min(least, distance2_from_hull(points[i].position, hull));
            }
            return least;
        });
    if (gone != chosen.end()) chosen.erase(gone);
    take(deepest);
    std::rotate(chosen.begin(), chosen.end() - 1, chosen.end());
    while (!left.empty() && chosen.size() < most_points) take(*std::ranges::max_element(left, {}, by_depth));
    return chosen;
}

std::vector<std::uint32_t> choose_contacts(std::span<const ManifoldPoint> points, std::size_t most) {
    std::vector<ManifoldPatch> patches;
    join_patches(points, patch_cosine, patches);
    std::vector<std::vector<std::uint32_t>> chosen;
    chosen.reserve(patches.size());
    for (const ManifoldPatch& patch : patches) chosen.push_back(choose_points(points, patch.points));
    std::vector<std::size_t> given(patches.size(), 0);
    std::vector<std::uint32_t> order;
    const auto give = [&](std::size_t patch) { order.push_back(chosen[patch][given[patch]++]); };
    // By the patches' depths (D'Hondt); what does not touch yet takes turns after that.
    const auto share = [&](std::size_t patch) {
        const double depth = points[patches[patch].points.front()].depth; // the deepest began it
        return depth > 0 ? std::pair(1, depth / double(given[patch] + 1)) : std::pair(0, -double(given[patch]));
    };
    while (order.size() < most) {
        std::size_t next = patches.size();
        for (std::size_t patch = 0; patch < patches.size(); ++patch)
            if (given[patch] < chosen[patch].size() && (next == patches.size() || share(patch) > share(next)))
                next = patch;
        if (next == patches.size()) break;
        give(next);
    }
    return order;
}

} // namespace raycontact
