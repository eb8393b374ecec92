// SPDX-License-Identifier: Apache-2.0
#include "mesh/nesting.h"

#include "mesh/measure.h"

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

/// Rays from the middle of a triangle into the space in front of it.
class FrontRays {
public:
    FrontRays(std::span<const Vec3> vertices, std::span<const Triangle> triangles, const TriangleBvh& bvh)
        : vertices_(vertices), triangles_(triangles), bvh_(bvh) {}

    /// All other triangles that one ray crosses. Directions are tried until one keeps clear, by more than rounding, of
    /// every edge and of surface at its origin; false when none does.
    bool cast(std::uint32_t from, std::vector<Crossing>& crossings) const {
        for (std::uint32_t attempt = 0; attempt < 32; ++attempt) {
            if (cast_along(from, attempt, crossings)) return true;
        }
        return false;
    }

private:
    static double random(std::uint32_t& state) { // -1 to 1, the same on every machine
        state = state * 1664525u + 1013904223u;
        return static_cast<double>(state >> 8) / 8388608.0 - 1;
    }

    bool cast_along(std::uint32_t from, std::uint32_t attempt, std::vector<Crossing>& crossings) const {
        const Vec3 &a = vertices_[triangles_[from][0]], &b = vertices_[triangles_[from][1]],
                   &c = vertices_[triangles_[from][2]];
        const Vec3 origin = (1.0 / 3) * (a + b + c);
        const Vec3 scaled = cross(b - a, c - a);
        const double size = length(scaled);
        if (!(size > 0)) return false;
        std::uint32_t state = attempt * 2654435761u + 1;
        Vec3 direction = (1 / size) * scaled;
        // At most 0.52 aside, so the ray stays in front.
        direction = direction + Vec3{0.3 * random(state), 0.3 * random(state), 0.3 * random(state)};
        if (direction.x == 0 || direction.y == 0 || direction.z == 0) return false;

        crossings.clear();
        bool clear = true;
        bvh_.along_ray(origin, direction, [&](std::uint32_t t) {
            if (t == from || !clear) return;
            const int sign = cross_triangle(origin, direction, triangles_[t], clear);
            if (sign != 0) crossings.push_back({t, sign});
        });
        return clear;
    }

    int cross_triangle(const Vec3& origin, const Vec3& direction, const Triangle& t, bool& clear) const {
        const Vec3 a = vertices_[t[0]] - origin, b = vertices_[t[1]] - origin, c = vertices_[t[2]] - origin;
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
        const double ahead_bound = 1e-14 * (reach_a + reach_b + reach_c) * length(normal);
        if (!unsure && std::fabs(ahead) > ahead_bound && (ahead > 0) != (along > 0)) return 0; // behind the origin
        if (unsure || std::fabs(ahead) <= ahead_bound) {
            clear = false;
            return 0;
        }
        return along > 0 ? 1 : -1;
    }

    std::span<const Vec3> vertices_;
    std::span<const Triangle> triangles_;
    const TriangleBvh& bvh_;
};

/// The triangles of each patch that reach furthest along each axis, either way: where a patch that pokes out of another
/// is not inside it, one of them usually shows it. By place, not by index, so the order of a file does not matter.
std::vector<std::array<std::uint32_t, 6>>
extreme_triangles(std::span<const Vec3> vertices, std::span<const Triangle> triangles, const Patches& patches) {
    std::vector<std::array<std::uint32_t, 6>> extremes(patches.list.size());
    for (std::size_t p = 0; p < extremes.size(); ++p) extremes[p].fill(patches.list[p].first);
    const auto reach = [&](std::uint32_t t, std::size_t way) {
        double most = -1e300;
        for (const std::uint32_t v : triangles[t])
            most = std::max(most, (way % 2 == 0 ? 1 : -1) * axis(vertices[v], way / 2));
        return most;
    };
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        std::array<std::uint32_t, 6>& best = extremes[patches.of[t]];
        for (std::size_t way = 0; way < 6; ++way) {
            if (reach(t, way) > reach(best[way], way)) best[way] = t;
        }
    }
    return extremes;
}

/// The closed patches around every given triangle of a patch: those that rays from there cross an odd number of times.
std::vector<std::uint32_t> patches_around(std::uint32_t own, std::span<const std::uint32_t> from,
                                          const Patches& patches, const FrontRays& rays) {
    std::vector<std::uint32_t> around, met, odd, both;
    std::vector<Crossing> crossings;
    for (std::size_t k = 0; k < from.size(); ++k) {
        odd.clear();
        met.clear();
        if (!rays.cast(from[k], crossings)) return {}; // not known: not nested
        for (const Crossing& crossing : crossings) met.push_back(patches.of[crossing.triangle]);
        std::sort(met.begin(), met.end());
        for (std::size_t first = 0, last = 0; first < met.size(); first = last) {
            while (last < met.size() && met[last] == met[first]) ++last;
            if ((last - first) % 2 == 1 && met[first] != own && patches.list[met[first]].closed)
                odd.push_back(met[first]);
        }
        both.clear();
        std::set_intersection(around.begin(), around.end(), odd.begin(), odd.end(), std::back_inserter(both));
        around = k == 0 ? odd : both;
        if (around.empty()) break;
    }
    return around;
}

} // namespace

std::vector<char> patches_to_turn(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                                  const Patches& patches, const TriangleBvh& bvh) {
    const std::size_t count = patches.list.size();
    const Vec3 near = box_of(vertices).middle();
    std::vector<LongSum> volumes(count), sizes(count);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const auto [a, b, c] = triangles[i];
        const double volume = dot(vertices[a] - near, cross(vertices[b] - near, vertices[c] - near)) / 6;
        volumes[patches.of[i]].add(volume);
        sizes[patches.of[i]].add(std::fabs(volume));
    }

    const FrontRays rays(vertices, triangles, bvh);
    std::vector<std::array<std::uint32_t, 6>> extremes;
    if (count > 1) extremes = extreme_triangles(vertices, triangles, patches);
    std::vector<char> turn(count, 0);
    for (std::uint32_t p = 0; p < count; ++p) {
        const double volume = volumes[p].value();
        if (!patches.list[p].closed || !(std::fabs(volume) > 1e-12 * sizes[p].value())) continue;
        const bool cavity = count > 1 && patches_around(p, extremes[p], patches, rays).size() % 2 == 1;
        turn[p] = (volume < 0) != cavity ? 1 : 0;
    }
    return turn;
}

// The winding number changes by one across every triangle and nowhere else. Without self-intersections the space right
// in front of a patch is connected and crosses no triangle (a patch goes on only over edges that have no third
// triangle), so one point in front of each patch, with winding number 0 there and hence 1 behind, speaks for all space
// next to the surface; and every region of space is next to some.
bool winds_outward(std::span<const Vec3> vertices, std::span<const Triangle> triangles, const Patches& patches,
                   const TriangleBvh& bvh) {
    const FrontRays rays(vertices, triangles, bvh);
    std::vector<std::uint32_t> largest(patches.list.size());
    std::vector<double> area(patches.list.size(), 0);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        const auto [a, b, c] = triangles[t];
        const double twice = length(cross(vertices[b] - vertices[a], vertices[c] - vertices[a]));
        if (twice > area[patches.of[t]]) {
            area[patches.of[t]] = twice;
            largest[patches.of[t]] = t;
        }
    }
    std::vector<Crossing> crossings;
    for (std::size_t p = 0; p < patches.list.size(); ++p) {
        if (area[p] == 0) continue; // degenerate triangles bound nothing
        if (!rays.cast(largest[p], crossings)) return false;
        int winding = 0;
        for (const Crossing& crossing : crossings) winding += crossing.sign;
        if (winding != 0) return false;
    }
    return true;
}

} // namespace raycontact
