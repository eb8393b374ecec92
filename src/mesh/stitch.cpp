// SPDX-License-Identifier: Apache-2.0
#include "mesh/stitch.h"

#include "interruption.h"
#include "mesh/vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace raycontact {
namespace {

/// The unit in which the coordinates are rounded: of a decimal fraction, as text has them, of a float, or of a double.
double last_digit(std::span<const Triangle> triangles, std::span<const Vec3> vertices) {
    constexpr double rounding = std::numeric_limits<double>::epsilon();
    double largest = 0;
    bool floats = true;
    const auto each = [&](auto&& visit) {
        for (const Triangle& t : triangles)
            for (const std::uint32_t v : t)
                for (const double x : {vertices[v].x, vertices[v].y, vertices[v].z})
                    if (!visit(x)) return false;
        return true;
    };
    each([&](double x) {
        largest = std::max(largest, std::fabs(x));
        floats = floats && x == double(static_cast<float>(x));
        return true;
    });
    for (double digit = 1, per = 1; digit > 64 * rounding * largest; digit /= 10, per *= 10)
        if (each([&](double x) {
                const double whole = std::round(x * per);
                return std::fabs(x * per - whole) <= 4 * rounding * std::fabs(x * per);
            }))
            return 1 / per;
    return (floats ? 0.5 * double(std::numeric_limits<float>::epsilon()) : 8 * rounding) * largest;
}

/// Vertices, found by where they are.
class Points {
public:
    Points(std::span<const Vec3> places, std::vector<std::uint32_t> vertices)
        : places_(places), order_(std::move(vertices)), halves_(order_.size()) {
        divide(0, order_.size());
    }

    /// Calls visit(vertex, place along the segment from 0 to 1, squared distance) for those within a distance.
    template <class Visit>
    void near_segment(const Vec3& from, const Vec3& to, double within, Visit&& visit) {
        Question<Visit> question{from, to - from, within, visit};
        ask(question, 0, order_.size(), 0, 1);
    }
    std::size_t visited() const { return visited_; }

private:
    static constexpr std::size_t few = 8;
    template <class Visit>
    struct Question {
        Vec3 from, way;
        double within;
        Visit& visit;
    };
    /// The first half lies below the split, the second above.
    struct Half {
        double split = 0;
        unsigned axis = 0;
    };
    static double along(const Vec3& p, unsigned axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

    void divide(std::size_t begin, std::size_t end) {
        if (end - begin <= few) return;
        Vec3 low = places_[order_[begin]], high = low;
        for (std::size_t i = begin; i < end; ++i) {
            low = least(low, places_[order_[i]]);
            high = most(high, places_[order_[i]]);
        }
        const Vec3 size = high - low;
        const unsigned axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::size_t middle = begin + (end - begin) / 2;
        const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t i, std::uint32_t k) {
            return std::pair(along(places_[i], axis), i) < std::pair(along(places_[k], axis), k);
        });
        halves_[middle] = {along(places_[order_[middle]], axis), axis};
        divide(begin, middle);
        divide(middle, end);
    }

    // Of the segment the part from first to last.
    template <class Visit>
    void ask(Question<Visit>& question, std::size_t begin, std::size_t end, double first, double last) {
        ++visited_;
        if (end - begin <= few) {
            for (std::size_t i = begin; i < end; ++i) {
                const Vec3 off = places_[order_[i]] - question.from;
                const double place = dot(off, question.way) / dot(question.way, question.way);
                const Vec3 aside = off - place * question.way;
                if (dot(aside, aside) <= question.within * question.within)
                    question.visit(order_[i], place, dot(aside, aside));
            }
            return;
        }
        const std::size_t middle = begin + (end - begin) / 2;
        const auto [split, axis] = halves_[middle];
        const double start = along(question.from, axis), step = along(question.way, axis);
        // Where it is below the upper bound of the first half, and above the lower one of the second.
        for (const bool upper : {false, true}) {
            const double bound = upper ? split - question.within : split + question.within;
            double from = first, to = last;
            if (step != 0) {
                const double meets = (bound - start) / step;
                if ((step > 0) == upper)
                    from = std::max(from, meets);
                else
                    to = std::min(to, meets);
            } else if (upper ? start < bound : start > bound) {
                continue;
            }
            if (from <= to) ask(question, upper ? middle : begin, upper ? end : middle, from, to);
        }
    }

    std::span<const Vec3> places_;
    std::vector<std::uint32_t> order_;
    std::vector<Half> halves_; ///< by place in the order, of a middle
    std::size_t visited_ = 0;
};

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

Stitched stitch_borders(std::span<const Triangle> triangles, std::span<const Vec3> vertices,
                        std::span<const HalfEdge> edges) {
    Stitched result;
    std::vector<std::uint32_t> corners, ends; // of border edges
    for_each_edge(edges, [&](std::span<const HalfEdge> sides) {
        if (sides.size() % 2 == 0) return;
        ends.insert(ends.end(), {sides[0].lo, sides[0].hi});
        if (sides.size() == 1) corners.push_back(sides[0].corner);
    });
    if (corners.empty()) return result;
    std::ranges::sort(ends);
    ends.erase(std::ranges::unique(ends).begin(), ends.end());
    Vec3 low = vertices[ends[0]], high = low;
    for (const std::uint32_t v : ends) {
        low = least(low, vertices[v]);
        high = most(high, vertices[v]);
    }
    const double within = std::min(2 * last_digit(triangles, vertices), 1e-4 * length(high - low));
    const std::size_t most_visits = 256 * (ends.size() + corners.size()) + 100'000;
    const std::size_t most_junctions = 4 * ends.size();
    Points points(vertices, std::move(ends));
    std::vector<Junction> junctions;
    const InterruptionCheck check;
    for (const std::uint32_t corner : corners) {
        check();
        const Triangle& t = triangles[corner / 3];
        const std::uint32_t a = t[corner % 3], b = t[(corner + 1) % 3];
        const double size = length(vertices[b] - vertices[a]);
        points.near_segment(vertices[a], vertices[b], within, [&](std::uint32_t v, double place, double away2) {
            if (place * size > within && (1 - place) * size > within)
                junctions.push_back({corner, place, v, std::sqrt(away2)});
        });
        result.given_up = points.visited() > most_visits || junctions.size() > most_junctions;
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
