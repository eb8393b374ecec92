// SPDX-License-Identifier: Apache-2.0
#include "mesh/stitch.h"

#include "mesh/input_file.h"
#include "mesh/measure.h"
#include "mesh/mesh_tree.h"
#include "mesh/vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

namespace raycontact {
namespace {

/// The unit in which the coordinates are rounded: of a decimal fraction, as text has them, of a float, or of a double.
double last_digit(std::span<const Vec3> vertices) {
    constexpr double rounding = std::numeric_limits<double>::epsilon();
    const auto all = [&](auto&& holds) {
        return std::ranges::all_of(vertices, [&](const Vec3& v) { return holds(v.x) && holds(v.y) && holds(v.z); });
    };
    double largest = 0;
    for (const Vec3& v : vertices) largest = std::max({largest, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
    for (double per = 1; per * 64 * rounding * largest < 1; per *= 10)
        if (all([&](double x) {
                return std::fabs(x * per - std::round(x * per)) <= 4 * rounding * std::fabs(x * per);
            }))
            return 1 / per;
    if (all([](double x) { return x == double(static_cast<float>(x)); }))
        return 0.5 * double(std::numeric_limits<float>::epsilon()) * largest;
    return 8 * rounding * largest;
}

/// A vertex on an edge.
struct Junction {
    std::uint32_t corner; ///< 3 x triangle + corner where the edge begins
    double place;         ///< from 0 to 1 along the edge from there
    std::uint32_t vertex;
    double away; ///< metres from the edge
};

Vec3 normal_of(const Triangle& t, std::span<const Vec3> vertices) {
    return cross(vertices[t[1]] - vertices[t[0]], vertices[t[2]] - vertices[t[0]]);
}

/// Splits the piece that has what is left of an edge; false if a half would have no area or look the other way.
bool split(std::vector<Triangle>& pieces, std::size_t& piece, unsigned edge, std::uint32_t vertex,
           std::span<const Vec3> vertices) {
    Triangle first = pieces[piece], second = first;
    first[(edge + 1) % 3] = second[edge] = vertex;
    const Vec3 whole = normal_of(pieces[piece], vertices);
    for (const Triangle& half : {first, second})
        if (!(dot(normal_of(half, vertices), whole) > 0)) return false;
    pieces[piece] = first;
    pieces.push_back(second);
    piece = pieces.size() - 1;
    return true;
}

} // namespace

double border_tolerance(std::span<const Vec3> vertices) {
    const Box box = box_of(vertices);
    return std::min(2 * last_digit(vertices), 1e-4 * length(box.high - box.low));
}

Stitched stitch_borders(std::span<const Triangle> triangles, std::span<const Vec3> vertices,
                        std::span<const HalfEdge> edges, double within, Executor& executor) {
    Stitched result;
    std::vector<std::uint32_t> corners; // where border edges begin that one triangle has
    for_each_edge(edges, [&](std::span<const HalfEdge> sides) {
        if (sides.size() == 1) corners.push_back(sides[0].corner);
    });
    if (corners.empty()) return result;
    const std::vector<std::uint32_t> ends = border_vertices(edges);
    std::vector<Triangle> points; // as triangles, for the tree
    for (const std::uint32_t v : ends) points.push_back({v, v, v});
    std::vector<std::uint32_t> all(points.size());
    std::iota(all.begin(), all.end(), 0u);
    const MeshTree tree(vertices, points, all, executor);
    const std::size_t most_blocks = 64 * (ends.size() + corners.size()) + 100'000;
    const std::size_t most_junctions = std::min(4 * ends.size(), most_triangles - triangles.size());
    std::size_t blocks = 0;
    std::vector<Junction> junctions;
    for (const std::uint32_t corner : corners) {
        const Triangle& t = triangles[corner / 3];
        const Vec3 &a = vertices[t[corner % 3]], &b = vertices[t[(corner + 1) % 3]], way = b - a;
        const double size = length(way);
        blocks += tree.near_segment(a, b, within, [&](std::uint32_t point) {
            const Vec3 off = vertices[ends[point]] - a;
            const double place = dot(off, way) / dot(way, way), away = length(off - place * way);
            if (away <= within && place * size > within && (1 - place) * size > within)
                junctions.push_back({corner, place, ends[point], away});
        });
        result.given_up = blocks > most_blocks || junctions.size() > most_junctions;
        if (result.given_up) return result;
    }
    if (junctions.empty()) return result;
    std::ranges::sort(junctions, {}, [](const Junction& j) { return std::tuple(j.corner, j.place, j.vertex); });

    result.triangles.reserve(triangles.size() + junctions.size());
    std::vector<Triangle> pieces;
    auto next = junctions.begin();
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        pieces.assign(1, triangles[t]);
        std::array<std::size_t, 3> piece_of{}; // which has what is left of an edge
        for (; next != junctions.end() && next->corner / 3 == t; ++next) {
            const unsigned edge = next->corner % 3;
            const std::size_t before = piece_of[edge];
            if (!split(pieces, piece_of[edge], edge, next->vertex, vertices)) continue;
            // The second half has the next edge, the first one that before.
            if (piece_of[(edge + 1) % 3] == before) piece_of[(edge + 1) % 3] = piece_of[edge];
            ++result.at;
            result.farthest = std::max(result.farthest, next->away);
        }
        result.split += pieces.size() > 1;
        result.triangles.insert(result.triangles.end(), pieces.begin(), pieces.end());
        result.of.insert(result.of.end(), pieces.size(), t);
    }
    return result;
}

} // namespace raycontact
