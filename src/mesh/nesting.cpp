// SPDX-License-Identifier: Apache-2.0
#include "mesh/nesting.h"

#include "mesh/degenerate.h"
#include "mesh/measure.h"
#include "mesh/odd_times.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace raycontact {
namespace {

struct Crossing {
    std::uint32_t triangle;
    int sign; ///< 1: from behind the triangle to its front, out of a body that winds outward
};

double random(std::uint32_t& state) { // -1 to 1, the same on every machine
    state = state * 1664525u + 1013904223u;
    return static_cast<double>(state >> 8) / 8388608.0 - 1;
}

/// How a ray crosses a triangle whose corners are relative to the ray's origin: the sign of the crossing, or 0. If
/// rounding could change that, `clear` becomes false.
int cross_triangle(const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c, bool& clear) {
    const double reach_a = length(a), reach_b = length(b), reach_c = length(c);
    const double speed = 1e-14 * length(direction);
    // Sides of the line at each edge, against a generous bound of their rounding.
    const std::array sides{dot(direction, cross(a, b)), dot(direction, cross(b, c)), dot(direction, cross(c, a))};
    const std::array bounds{speed * reach_a * reach_b, speed * reach_b * reach_c, speed * reach_c * reach_a};
    bool positive = false, negative = false, unsure = false;
    for (std::size_t i = 0; i < 3; ++i) {
        positive = positive || sides[i] > bounds[i];
        negative = negative || sides[i] < -bounds[i];
        unsure = unsure || std::fabs(sides[i]) <= bounds[i];
    }
    if (positive && negative) return 0;
    const Vec3 normal = cross(b - a, c - a);
    const double ahead = dot(a, normal), along = dot(direction, normal);
    if (unsure || std::fabs(ahead) <= 1e-14 * (reach_a + reach_b + reach_c) * length(normal)) {
        clear = false;
        return 0;
    }
    if ((ahead > 0) != (along > 0)) return 0; // behind the origin
    return along > 0 ? 1 : -1;
}

Vec3 middle_of(std::uint32_t triangle, const PreparedMesh& mesh) {
    const auto [a, b, c] = mesh.triangles[triangle];
    return (1.0 / 3) * (mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]);
}

/// Finds all triangles but some that a ray from a point of a triangle crosses in the space in front of it. Tries
/// directions until one is clear, by more than rounding, of every edge and of surface at its origin; false if none is.
/// Counts the triangles that it looks at.
bool cast_from(std::uint32_t from, const Vec3& origin, const PreparedMesh& mesh, const MeshTree& tree,
               std::span<const std::uint32_t> without, std::vector<Crossing>& crossings, std::size_t& looked_at) {
    const auto corners = [&](std::uint32_t t) {
        const auto [a, b, c] = mesh.triangles[t];
        return std::array{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
    };
    const auto [a, b, c] = corners(from);
    const Vec3 scaled = cross(b - a, c - a);
    const double size = length(scaled);
    if (!(size > 0)) return false;
    for (std::uint32_t attempt = 0; attempt < 32; ++attempt) {
        std::uint32_t state = attempt * 2654435761u + 1;
        // At most 0.52 aside, so the ray stays in front.
        const Vec3 direction =
            (1 / size) * scaled + Vec3{0.3 * random(state), 0.3 * random(state), 0.3 * random(state)};
        if (direction.x == 0 || direction.y == 0 || direction.z == 0) continue;
        crossings.clear();
        bool clear = true;
        tree.along_ray(origin, direction, [&](std::uint32_t t) {
            ++looked_at;
            if (!clear || std::ranges::find(without, t) != without.end()) return;
            const auto [p, q, r] = corners(t);
            const int sign = cross_triangle(direction, p - origin, q - origin, r - origin, clear);
            if (sign != 0) crossings.push_back({t, sign});
        });
        if (clear) return true;
    }
    return false;
}

/// The triangles of each patch that reach furthest along each axis, either way: if a patch pokes out of another, one of
/// them usually shows that it is not inside. By place, not by index, so the order of a file does not matter. Degenerate
/// triangles have no front to look from.
std::vector<std::array<std::uint32_t, 6>> extreme_triangles(const PreparedMesh& mesh, const Patches& patches) {
    std::vector<std::array<std::uint32_t, 6>> extremes(patches.list.size());
    constexpr std::uint32_t none = 0xffffffffu;
    for (std::array<std::uint32_t, 6>& extreme : extremes) extreme.fill(none);
    const auto reach = [&](std::uint32_t t, std::size_t way) {
        double most = -1e300;
        for (const std::uint32_t v : mesh.triangles[t])
            most = std::max(most, (way % 2 == 0 ? 1 : -1) * axis(mesh.vertices[v], way / 2));
        return most;
    };
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        if (is_degenerate(mesh.triangles[t], mesh.vertices)) continue;
        std::array<std::uint32_t, 6>& best = extremes[patches.of[t]];
        for (std::size_t way = 0; way < 6; ++way) {
            if (best[way] == none || reach(t, way) > reach(best[way], way)) best[way] = t;
        }
    }
    for (std::size_t p = 0; p < extremes.size(); ++p)
        if (extremes[p][0] == none) extremes[p].fill(patches.list[p].first);
    return extremes;
}

/// The signed volume of each patch; 0 where it is open, or where rounding could change the sign.
std::vector<double> volumes_of(const PreparedMesh& mesh, const Patches& patches) {
    const std::size_t count = patches.list.size();
    // About a vertex of its own: seen from afar, the volume of a small patch is lost in the rounding of the sum.
    std::vector<LongSum> sums(count), roundings(count);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto [a, b, c] = mesh.triangles[i];
        const std::uint32_t p = patches.of[i];
        const Vec3 reach = mesh.vertices[a] - mesh.vertices[mesh.triangles[patches.list[p].first][0]];
        const Vec3 ab = mesh.vertices[b] - mesh.vertices[a], ac = mesh.vertices[c] - mesh.vertices[a];
        sums[p].add(dot(reach, cross(ab, ac)) / 6);
        roundings[p].add(1e-14 * length(reach) * length(ab) * length(ac)); // a generous bound
    }
    std::vector<double> volumes(count, 0);
    for (std::size_t p = 0; p < count; ++p)
        if (patches.list[p].closed && std::fabs(sums[p].value()) > roundings[p].value()) volumes[p] = sums[p].value();
    return volumes;
}

/// Finds the closed patches around others.
class Surroundings {
public:
    Surroundings(const PreparedMesh& mesh, const Patches& patches, const LazyTree& tree)
        : mesh_(mesh), patches_(patches), tree_(tree) {}

    /// The closed patches that surround every extreme triangle of a patch, ascending; none where rounding leaves that
    /// open. A patch surrounds a triangle if a ray from there crosses it an odd number of times. nullopt: all rays
    /// together meet too many triangles, as those of a million shells in each other would.
    std::optional<std::vector<std::uint32_t>> of(std::uint32_t own) {
        std::vector<std::uint32_t> around, crossed, both;
        if (patches_.list.size() == 1) return around;
        if (extremes_.empty()) extremes_ = extreme_triangles(mesh_, patches_);
        for (std::size_t k = 0; k < 6; ++k) {
            if (looked_at_ > (std::size_t{1} << 22) + 128 * mesh_.triangles.size()) return std::nullopt;
            const std::uint32_t from = extremes_[own][k];
            if (!cast_from(from, middle_of(from, mesh_), mesh_, tree_(), std::span(&from, 1), crossings_, looked_at_))
                return std::vector<std::uint32_t>();
            crossed.clear();
            for (const Crossing& crossing : crossings_) {
                const std::uint32_t patch = patches_.of[crossing.triangle];
                if (patch != own && patches_.list[patch].closed) crossed.push_back(patch);
            }
            keep_odd_times(crossed);
            both.clear();
            std::ranges::set_intersection(around, crossed, std::back_inserter(both));
            around = k == 0 ? crossed : both;
            if (around.empty()) break;
        }
        return around;
    }

private:
    const PreparedMesh& mesh_;
    const Patches& patches_;
    const LazyTree& tree_;
    std::vector<std::array<std::uint32_t, 6>> extremes_;
    std::vector<Crossing> crossings_;
    std::size_t looked_at_ = 0; ///< triangles
};

} // namespace

Turns patches_to_turn(const PreparedMesh& mesh, const Patches& patches, const LazyTree& tree, Nesting nesting) {
    const std::vector<double> volumes = volumes_of(mesh, patches);
    Surroundings surroundings(mesh, patches, tree);
    Turns turns{std::vector<char>(volumes.size(), 0)};
    for (std::uint32_t p = 0; p < volumes.size(); ++p) {
        const bool inward = volumes[p] < 0;
        if (volumes[p] == 0 || (!inward && nesting != Nesting::cavities)) continue;
        bool turn = inward;
        if (nesting != Nesting::solids) {
            const auto around = surroundings.of(p);
            if (!around) {
                ++turns.unknown;
                continue;
            }
            turn = nesting == Nesting::cavities ? inward != (around->size() % 2 == 1) : around->empty();
        }
        turns.patches[p] = turn ? 1 : 0;
    }
    return turns;
}

std::optional<int> Winding::in_front_of(std::uint32_t triangle, const Vec3& point,
                                        std::span<const std::uint32_t> without) const {
    if (is_too_much()) return std::nullopt;
    std::vector<Crossing> crossings;
    std::size_t looked_at = 0;
    const bool clear = cast_from(triangle, point, mesh_, tree_, without, crossings, looked_at);
    looked_at_ += looked_at;
    if (!clear) return std::nullopt;
    int winding = 0;
    for (const Crossing& crossing : crossings) winding += crossing.sign;
    return winding;
}

std::optional<std::vector<std::uint32_t>> solids_around(const PreparedMesh& mesh, const Patches& patches,
                                                        const LazyTree& tree) {
    const std::vector<double> volumes = volumes_of(mesh, patches);
    Surroundings surroundings(mesh, patches, tree);
    std::vector<std::uint32_t> solids(volumes.size());
    for (std::uint32_t p = 0; p < volumes.size(); ++p) {
        solids[p] = p;
        if (!(volumes[p] < 0)) continue;
        const auto around = surroundings.of(p);
        if (!around) return std::nullopt;
        for (const std::uint32_t other : *around)
            if (volumes[other] > 0 && (solids[p] == p || volumes[other] < volumes[solids[p]])) solids[p] = other;
    }
    return solids;
}

// The winding number changes by one across every triangle and nowhere else. Without self-intersections the space right
// in front of a patch is connected and crosses no triangle (a patch continues only across edges that have no third
// triangle), so one point in front of each patch, with winding number 0 there and hence 1 behind, represents all space
// next to the surface; and every region of space is next to some surface.
bool winds_outward(const PreparedMesh& mesh, const Patches& patches, const MeshTree& tree) {
    std::vector<std::uint32_t> largest(patches.list.size());
    std::vector<double> area(patches.list.size(), 0);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto [a, b, c] = mesh.triangles[t];
        const double twice = length(cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]));
        if (twice > area[patches.of[t]]) {
            area[patches.of[t]] = twice;
            largest[patches.of[t]] = t;
        }
    }
    const Winding winding(mesh, tree);
    for (std::size_t p = 0; p < patches.list.size(); ++p) {
        if (area[p] == 0) continue; // degenerate triangles bound nothing
        if (winding.in_front_of(largest[p], middle_of(largest[p], mesh), std::span(&largest[p], 1)) != 0) return false;
    }
    return true;
}

} // namespace raycontact
