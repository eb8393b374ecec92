// SPDX-License-Identifier: Apache-2.0
#include "query/surfaces.h"

#include "mesh/triangle_pair.h"
#include "shape/mesh_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace raycontact {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double touching = std::numeric_limits<double>::min(); // m^2: only what is nearer, at 0, is looked at
using Corners = std::array<Vec3, 3>;
using PlacedCorners = std::array<PlacedPoint, 3>;

Corners rough(const PlacedCorners& t) {
    return {t[0].rough, t[1].rough, t[2].rough};
}

Box grown(const Box& box, double by) {
    const Vec3 grow{by, by, by};
    return {box.low - grow, box.high + grow};
}

// How far a point of a triangle's plane is outside of the triangle, roughly; 0 inside.
double off_triangle(const Vec3& p, const Corners& t) {
    const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
    double off = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 along = t[(k + 1) % 3] - t[k];
        off = std::max(off, -dot(cross(along, p - t[k]), normal) / (length(along) * length(normal)));
    }
    return off;
}

// Where two triangles that meet do so, to rounding: where an edge of one passes the other, or, in a common plane, a
// corner of one or the middle of what their boxes share.
Vec3 meeting_point(const Corners& p, const Corners& q) {
    const Box a = box_of(p), b = box_of(q);
    Vec3 best = 0.5 * (most(a.low, b.low) + least(a.high, b.high));
    double least_off = infinite;
    const auto consider = [&](const Corners& edges, const Corners& t) {
        const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 &from = edges[k], &to = edges[(k + 1) % 3];
            const double before = dot(normal, from - t[0]), after = dot(normal, to - t[0]);
            if (before * after > 0) continue;
            const double part = before == after ? 0 : before / (before - after);
            const Vec3 at = from + part * (to - from);
            const double off = off_triangle(at, t);
            if (off >= least_off) continue;
            least_off = off;
            best = at;
        }
    };
    consider(p, q);
    consider(q, p);
    return best;
}

/// Two points and their squared distance, m^2.
struct Span {
    double squared = infinite;
    Vec3 a, b;

    void shorten(const Vec3& to_a, const Vec3& to_b) {
        const Vec3 off = to_a - to_b;
        if (dot(off, off) < squared) *this = {dot(off, off), to_a, to_b};
    }
};

// Where two lines are closest, if that is within both segments; else an end of one is closest, and another looks there.
void shorten_between_edges(Span& span, const Vec3& p, const Vec3& p_end, const Vec3& q, const Vec3& q_end) {
    const Vec3 u = p_end - p, v = q_end - q, w = p - q;
    const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), uw = dot(u, w), vw = dot(v, w);
    const double denominator = uu * vv - uv * uv;
    if (!(denominator > 0)) return;
    const double s = (uv * vw - vv * uw) / denominator;
    if (!(s >= 0 && s <= 1)) return;
    const double t = (uv * s + vw) / vv;
    if (t >= 0 && t <= 1) span.shorten(p + s * u, q + t * v);
}

// Of triangles that do not meet: from a corner of one to the other, or between two edges.
void shorten_between(Span& span, const Corners& p, const Corners& q) {
    for (const Vec3& corner : p) span.shorten(corner, nearest_point(corner, q[0], q[1], q[2]));
    for (const Vec3& corner : q) span.shorten(nearest_point(corner, p[0], p[1], p[2]), corner);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) shorten_between_edges(span, p[i], p[(i + 1) % 3], q[k], q[(k + 1) % 3]);
}

/// Looks at the pairs of triangles of two blocks. Those in boxes that touch are asked whether they meet.
class BlockPair {
public:
    explicit BlockPair(const ShapePair& pair) : pair_(pair), grow_(rounding_of(pair.b().shape())) {}

    bool meets() const { return found_.meet; }
    const TrianglePair& found() const { return found_; }
    double squared() const { return squared_; } ///< of the closest so far, m^2

    /// Calls each(a, corners, b) for the triangles whose boxes are within the root of squared(), until two meet.
    template <class Apart>
    void look(const kernels::TriangleBlock& of_a, const kernels::TriangleBlock& of_b, Apart&& apart) {
        const BlockBoxes boxes(of_b, grow_);
        for (const std::uint32_t a : of_a.triangle) {
            if (a == NONE || pair_.a().is_flat(a)) continue;
            const PlacedCorners p = pair_.triangle_of_a(a);
            const Lanes<double> squares = boxes.squared_distances(grown(box_of(rough(p)), pair_.error()));
            for (std::size_t lane = 0; lane < TRIANGLE_LANES; ++lane) {
                const std::uint32_t b = of_b.triangle[lane];
                if (!(squares[lane] < squared_) || b == NONE || pair_.b().shape().is_flat(b)) continue;
                const PlacedCorners q = pair_.b().triangle(b);
                const Corners corners_a = rough(p), corners_b = rough(q);
                if (squares[lane] == 0 && triangles_meet(p, q)) {
                    const Vec3 point = meeting_point(corners_a, corners_b);
                    found_ = {a, b, point, point, true};
                    squared_ = 0;
                    return;
                }
                apart(a, corners_a, b, corners_b);
            }
        }
    }

    void limit(double squared) { squared_ = squared; }
    /// Of triangles that do not meet, so it stays above 0, though it may round to that.
    void set(double squared, const TrianglePair& closest) {
        squared_ = std::max(squared, touching);
        found_ = closest;
    }

private:
    const ShapePair& pair_;
    double grow_;
    double squared_ = infinite;
    TrianglePair found_;
};

double gap(const Box& a, const Box& b) {
    const Vec3 off = most(most(a.low - b.high, b.low - a.high), Vec3{});
    return dot(off, off);
}

} // namespace

std::optional<TrianglePair> meeting_triangles(const ShapePair& pair) {
    if (pair.far_apart()) return std::nullopt;
    BlockPair blocks(pair);
    blocks.limit(touching);
    pair.each_tree([&](const TriangleTree& a, const TriangleTree& b) {
        nearest_pairs_first<float>(
            a, b, [&] { return blocks.meets() ? 0 : std::numeric_limits<float>::infinity(); },
            [&](Side side, const kernels::Node& node, const Box& other, Lanes<float>& lanes) {
                const Box box = pair.box_in(side, other);
                const Vec3 middle = box.middle();
                // The nearest middles first: deep in one another, they are likely to meet.
                for (std::size_t lane = 0; lane < NODE_LANES; ++lane) {
                    const Box child = box_of(node, lane);
                    const Vec3 off = child.middle() - middle;
                    lanes[lane] = child.touches(box) ? static_cast<float>(std::min(dot(off, off), 1e30))
                                                     : std::numeric_limits<float>::infinity();
                }
            },
            [&](const kernels::TriangleBlock& of_a, const kernels::TriangleBlock& of_b) {
                if (!blocks.meets())
                    blocks.look(of_a, of_b, [](std::uint32_t, const Corners&, std::uint32_t, const Corners&) {});
            });
    });
    return blocks.meets() ? std::optional(blocks.found()) : std::nullopt;
}

std::optional<TrianglePair> closest_triangles(const ShapePair& pair, double farthest) {
    BlockPair blocks(pair);
    // Beyond it by a rounding, so that what is there exactly is found.
    blocks.limit(std::max(farthest * farthest * (1 + 1e-12), touching));
    pair.each_tree([&](const TriangleTree& a, const TriangleTree& b) {
        nearest_pairs_first<double>(
            a, b, [&] { return blocks.squared(); },
            [&](Side side, const kernels::Node& node, const Box& other, Lanes<double>& lanes) {
                const Box box = pair.box_in(side, other);
                for (std::size_t lane = 0; lane < NODE_LANES; ++lane) lanes[lane] = gap(box_of(node, lane), box);
            },
            [&](const kernels::TriangleBlock& of_a, const kernels::TriangleBlock& of_b) {
                if (blocks.meets()) return;
                blocks.look(of_a, of_b, [&](std::uint32_t s, const Corners& p, std::uint32_t t, const Corners& q) {
                    Span span{blocks.squared(), {}, {}};
                    shorten_between(span, p, q);
                    if (span.squared < blocks.squared()) blocks.set(span.squared, {s, t, span.a, span.b, false});
                });
            });
    });
    return blocks.found().a != NONE ? std::optional(blocks.found()) : std::nullopt;
}

} // namespace raycontact
