// SPDX-License-Identifier: Apache-2.0
#include "query/surfaces.h"

#include "mesh/triangle_pair.h"
#include "query/triangle_distance.h"
#include "shape/mesh_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace raycontact {

namespace {

Box grown(const Box& box, double by) {
    const Vec3 grow{by, by, by};
    return {box.low - grow, box.high + grow};
}

/// The box of a child by its middle.
template <class Number>
struct ChildBox {
    Number middle[3], half[3];
    ChildBox(const kernels::Node& node, std::size_t lane) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto low = Number(node.bounds[k][lane]), high = Number(node.bounds[3 + k][lane]);
            middle[k] = Number(0.5) * (low + high);
            half[k] = Number(0.5) * (high - low);
        }
    }
};

/// A box of the other tree, for the children of a node: along the axes of either frame they are off each other by no
/// less than is told. Of turned boxes one frame alone often shows no gap. Loops over lanes become side by side.
template <class Number>
class TwoFrames {
public:
    /// error: of all that is told, metres, at most.
    TwoFrames(const ShapePair& pair, Side side, const Box& other, double error) {
        const Pose& out = pair.out_of(side);
        const Box own = pair.box_in(side, other);
        for (std::size_t k = 0; k < 3; ++k) {
            const double low = axis(own.low, k), high = axis(own.high, k);
            own_middle[k] = Number(0.5 * (low + high));
            own_half_[k] = Number(0.5 * (high - low) + error);
            const double from = axis(other.low, k), to = axis(other.high, k);
            away_[k] = Number(axis(out.translation, k) - 0.5 * (from + to));
            half_[k] = Number(0.5 * (to - from) + error);
            for (std::size_t i = 0; i < 3; ++i) {
                turn_[k][i] = Number(out.rotation[3 * k + i]);
                reach_[k][i] = std::fabs(turn_[k][i]);
            }
        }
    }

    Number off_own(const ChildBox<Number>& child, std::size_t k) const {
        return std::fabs(child.middle[k] - own_middle[k]) - (child.half[k] + own_half_[k]);
    }
    Number off_others(const ChildBox<Number>& child, std::size_t k) const {
        const Number at = turn_[k][0] * child.middle[0] + turn_[k][1] * child.middle[1] + turn_[k][2] * child.middle[2];
        const Number half = reach_[k][0] * child.half[0] + reach_[k][1] * child.half[1] + reach_[k][2] * child.half[2];
        return std::fabs(at + away_[k]) - (half + half_[k]);
    }

    Number own_middle[3]; ///< of the box in the node's frame

private:
    Number own_half_[3], away_[3], half_[3], turn_[3][3], reach_[3][3];
};

/// Asks pairs of triangles whether they meet.
class Meeting {
public:
    explicit Meeting(const ShapePair& pair)
        : pair_(pair), grow_a_(rounding_of(pair.a()) + float_rounding_of(pair)),
          grow_b_(rounding_of(pair.b().shape()) + float_rounding_of(pair)) {}

    const std::optional<MeetingTriangles>& found() const { return found_; }

    void look(const kernels::TriangleBlock& of_a, const kernels::TriangleBlock& of_b) {
        const BlockBoxes boxes_a(of_a, grow_a_), boxes_b(of_b, grow_b_);
        const Lanes<float> squares_a = boxes_a.squared_distances(pair_.box_in(Side::a, boxes_b.whole()));
        for (std::size_t i = 0; i < TRIANGLE_LANES; ++i) {
            const std::uint32_t a = of_a.triangle[i];
            if (squares_a[i] > 0 || pair_.a().is_flat(a)) continue;
            const std::array<PlacedPoint, 3> p = pair_.triangle_of_a(a);
            const Corners corners{p[0].rough, p[1].rough, p[2].rough};
            const Lanes<float> squares_b = boxes_b.squared_distances(grown(box_of(corners), pair_.error()));
            for (std::size_t k = 0; k < TRIANGLE_LANES; ++k) {
                const std::uint32_t b = of_b.triangle[k];
                if (squares_b[k] > 0 || pair_.b().shape().is_flat(b)) continue;
                if (!triangles_meet(p, pair_.b().triangle(b))) continue;
                found_ = {a, b};
                return;
            }
        }
    }

private:
    const ShapePair& pair_;
    double grow_a_, grow_b_;
    std::optional<MeetingTriangles> found_;
};

/// The closest of the triangles seen so far. The way between them nearly parts all that is farther: along it, both
/// meshes are seen without the slack of boxes that are turned.
class Closest {
public:
    /// limit: only what is nearer counts, m^2.
    Closest(const ShapePair& pair, double limit)
        : pair_(pair), grow_a_(rounding_of(pair.a()) + float_rounding_of(pair)),
          grow_b_(rounding_of(pair.b().shape()) + float_rounding_of(pair)), squared_(limit),
          is_round_(pair.radius() > 0) {
        go({});
    }

    const std::optional<TrianglePair>& found() const { return found_; }
    double squared() const { return squared_; } ///< m^2

    /// How far the children of a node are from a box of the other tree, each in its own frame, m^2 at least.
    void fill_gaps(Side side, const kernels::Node& node, const Box& other, Lanes<double>& lanes) const {
        const TwoFrames<double> frames(pair_, side, other, pair_.error());
        const Vec3 &own = side == Side::a ? forth_ : back_, &others = side == Side::a ? back_ : forth_;
        const double reach = most_along(other, others) + shift_;
        for (std::size_t lane = 0; lane < NODE_LANES; ++lane) {
            const ChildBox<double> child(node, lane);
            const double along = own.x * child.middle[0] + own.y * child.middle[1] + own.z * child.middle[2]
                                 + std::fabs(own.x) * child.half[0] + std::fabs(own.y) * child.half[1]
                                 + std::fabs(own.z) * child.half[2];
            const double parted = std::max(-(along + reach), 0.0);
            double in_own = 0, in_others = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const double here = std::max(frames.off_own(child, k), 0.0);
                const double there = std::max(frames.off_others(child, k), 0.0);
                in_own += here * here;
                in_others += there * there;
            }
            lanes[lane] = std::max(std::max(in_own, in_others), parted * parted);
        }
    }

    void look(const kernels::TriangleBlock& of_a, const kernels::TriangleBlock& of_b) {
        Along along(*this, of_a, of_b);
        if (is_beyond(along.first_of_b - along.last_of_a)) return;
        const BlockBoxes boxes_a(of_a, grow_a_), boxes_b(of_b, grow_b_);
        const Lanes<float> squares = boxes_a.squared_distances(pair_.box_in(Side::a, boxes_b.whole()));
        for (const std::size_t lane : by_rising(squares)) {
            const std::uint32_t a = of_a.triangle[lane];
            if (!(squares[lane] < squared_)) return;
            if (is_beyond(along.first_of_b - along.a[lane]) || pair_.a().is_flat(a)) continue;
            if (look(a, along.a[lane], of_b, boxes_b, along.b)) along = Along(*this, of_a, of_b);
        }
    }

private:
    /// Where along the way the triangles of a end, and those of b begin, metres.
    struct Along {
        Lanes<double> a, b;
        double last_of_a, first_of_b;

        Along(const Closest& closest, const kernels::TriangleBlock& of_a, const kernels::TriangleBlock& of_b)
            : a(least_along(of_a, Vec3{} - closest.forth_)), b(least_along(of_b, Vec3{} - closest.back_)) {
            for (double& end : a) end = closest.shift_ + closest.grow_a_ - end;
            for (double& begin : b) begin -= closest.grow_b_;
            last_of_a = *std::max_element(a.begin(), a.end());
            first_of_b = *std::min_element(b.begin(), b.end());
        }
    };

    static double most_along(const Box& box, const Vec3& way) {
        const Vec3 half = 0.5 * (box.high - box.low);
        return dot(way, box.middle()) + std::fabs(way.x) * half.x + std::fabs(way.y) * half.y
               + std::fabs(way.z) * half.z;
    }
    /// Of a gap along the way.
    bool is_beyond(double metres) const { return metres > 0 && metres * metres >= squared_; }

    // Empty lanes, which are infinitely far, come last.
    static std::array<std::size_t, NODE_LANES> by_rising(const Lanes<float>& squares) {
        std::array<std::size_t, NODE_LANES> order;
        for (std::size_t lane = 0; lane < NODE_LANES; ++lane) {
            std::size_t at = lane;
            for (; at > 0 && squares[order[at - 1]] > squares[lane]; --at) order[at] = order[at - 1];
            order[at] = lane;
        }
        return order;
    }

    // A triangle of a, which ends there along the way, and those of a block of b. Whether one is the closest now.
    bool look(std::uint32_t a, double end, const kernels::TriangleBlock& of_b, const BlockBoxes& boxes,
              const Lanes<double>& begins) {
        const Corners corners = pair_.corners_of_a(a);
        const Lanes<float> squares = boxes.squared_distances(grown(box_of(corners), pair_.error()));
        // The nearest first: what it leaves is less.
        const auto nearest =
            static_cast<std::size_t>(std::min_element(squares.begin(), squares.end()) - squares.begin());
        const Face face(corners);
        bool closer = look(a, face, of_b.triangle[nearest], squares[nearest]);
        for (std::size_t lane = 0; lane < TRIANGLE_LANES; ++lane)
            if (lane != nearest && !is_beyond(begins[lane] - end))
                closer = look(a, face, of_b.triangle[lane], squares[lane]) || closer;
        return closer;
    }

    bool look(std::uint32_t a, const Face& face, std::uint32_t b, double box_square) {
        if (!(box_square < squared_) || pair_.b().shape().is_flat(b)) return false;
        Span span{squared_, {}, {}};
        const Face other(pair_.corners_of_b(b));
        shorten_between(span, face, other);
        if (is_round_) { // cores cross faces where bodies meet
            if (const auto point = crossing_of(face, other)) span.shorten(*point, *point);
            if (const auto point = crossing_of(other, face)) span.shorten(*point, *point);
        }
        if (!(span.squared < squared_)) return false;
        squared_ = span.squared;
        found_ = {a, b, span.a, span.b};
        go(unit(span.b - span.a));
        return true;
    }

    // way: unit, or 0, which parts nothing; centred frame of b.
    void go(const Vec3& way) {
        forth_ = rotated_back(pair_.a_in_b().rotation, way);
        back_ = Vec3{} - way;
        shift_ = dot(way, pair_.a_in_b().translation) + pair_.error();
    }

    const ShapePair& pair_;
    double grow_a_, grow_b_, squared_;
    bool is_round_; ///< one of the bodies
    std::optional<TrianglePair> found_;
    /// The way from a to b in the centred frame of a, the way back in that of b, and how far the first is behind the
    /// second, metres.
    Vec3 forth_, back_;
    double shift_ = 0;
};

// Visits the blocks whose boxes touch until done(): the nearest middles first, as deep in one another they are likely
// to meet.
template <class Done, class Visit>
void descend_to_touching(const ShapePair& pair, Done&& done, Visit&& visit) {
    if (pair.far_apart()) return;
    constexpr float never = std::numeric_limits<float>::infinity();
    const double rounding = float_rounding_of(pair);
    pair.each_tree([&](const TriangleTree& a, const TriangleTree& b) {
        nearest_pairs_first<float>(
            a, b, [&] { return done() ? 0 : never; },
            [&](Side side, const kernels::Node& node, const Box& other, Lanes<float>& lanes) {
                const TwoFrames<float> frames(pair, side, other, rounding);
                for (std::size_t lane = 0; lane < NODE_LANES; ++lane) {
                    const ChildBox<float> child(node, lane);
                    float off = 0, squared = 0;
                    for (std::size_t k = 0; k < 3; ++k) {
                        off = std::max(off, std::max(frames.off_own(child, k), frames.off_others(child, k)));
                        const float away = child.middle[k] - frames.own_middle[k];
                        squared += away * away;
                    }
                    lanes[lane] = off > 0 ? never : std::min(squared, 1e30f);
                }
            },
            visit);
    });
}

} // namespace

std::optional<MeetingTriangles> meeting_triangles(const ShapePair& pair) {
    Meeting meeting(pair);
    descend_to_touching(
        pair, [&] { return meeting.found().has_value(); },
        [&](const kernels::TriangleBlock& of_a, const kernels::TriangleBlock& of_b) {
            if (!meeting.found()) meeting.look(of_a, of_b);
        });
    return meeting.found();
}

void each_touching_pair(const ShapePair& pair, const std::function<void(std::uint32_t a, std::uint32_t b)>& visit) {
    const double grow_a = rounding_of(pair.a()) + float_rounding_of(pair),
                 grow_b = rounding_of(pair.b().shape()) + float_rounding_of(pair);
    descend_to_touching(
        pair, [] { return false; },
        [&](const kernels::TriangleBlock& of_a, const kernels::TriangleBlock& of_b) {
            const BlockBoxes boxes_a(of_a, grow_a), boxes_b(of_b, grow_b);
            const Lanes<float> squares_a = boxes_a.squared_distances(pair.box_in(Side::a, boxes_b.whole()));
            for (std::size_t i = 0; i < TRIANGLE_LANES; ++i) {
                const std::uint32_t a = of_a.triangle[i];
                if (a == NONE || squares_a[i] > 0) continue;
                const Lanes<float> squares_b =
                    boxes_b.squared_distances(grown(box_of(pair.corners_of_a(a)), grow_a + pair.error()));
                for (std::size_t k = 0; k < TRIANGLE_LANES; ++k)
                    if (of_b.triangle[k] != NONE && !(squares_b[k] > 0)) visit(a, of_b.triangle[k]);
            }
        });
}

std::optional<TrianglePair> closest_triangles(const ShapePair& pair, double farthest) {
    // Beyond it by a rounding, so that what is there exactly is found.
    Closest closest(pair, farthest * farthest * (1 + 1e-12));
    pair.each_tree([&](const TriangleTree& a, const TriangleTree& b) {
        nearest_pairs_first<double>(
            a, b, [&] { return closest.squared(); },
            [&](Side side, const kernels::Node& node, const Box& other, Lanes<double>& lanes) {
                closest.fill_gaps(side, node, other, lanes);
            },
            [&](const kernels::TriangleBlock& of_a, const kernels::TriangleBlock& of_b) { closest.look(of_a, of_b); });
    });
    return closest.found();
}

} // namespace raycontact
