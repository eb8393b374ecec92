// SPDX-License-Identifier: Apache-2.0
#include "query/first_meeting.h"

#include "interruption.h"
#include "mesh/descent.h"
#include "query/triangle_distance.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace raycontact {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();
/// Radians that both turn during one search: then boxes are looked at anew, from the roots.
constexpr double most_turn = 0.25;

/// A node of a shape, a block of triangles or a triangle, and its box in the centred frame.
struct Part {
    enum class Kind : std::uint8_t { triangle, block, node };
    std::array<float, 3> low, high;
    std::uint32_t index = 0;
    Kind kind = Kind::node;
    bool of_slivers = false;

    Vec3 middle() const {
        return {0.5 * (double(low[0]) + high[0]), 0.5 * (double(low[1]) + high[1]), 0.5 * (double(low[2]) + high[2])};
    }
    Vec3 half() const {
        return {0.5 * (double(high[0]) - low[0]), 0.5 * (double(high[1]) - low[1]), 0.5 * (double(high[2]) - low[2])};
    }
    double size() const { return double(high[0]) - low[0] + (double(high[1]) - low[1]) + (double(high[2]) - low[2]); }
};

/// The parts that one part holds.
struct Children {
    std::array<Part, NODE_LANES> part;
    std::size_t count = 0;
};

Children children_of(const ShapeData& shape, const Part& parent) {
    Children children;
    const TriangleTree& tree = parent.of_slivers ? shape.slivers : shape;
    if (parent.kind == Part::Kind::node) {
        const kernels::Node& node = tree.nodes[parent.index];
        for (std::size_t lane = 0; lane < NODE_LANES; ++lane) {
            if (node.child[lane] == NONE) continue;
            Part& part = children.part[children.count++];
            for (std::size_t k = 0; k < 3; ++k) {
                part.low[k] = node.bounds[k][lane];
                part.high[k] = node.bounds[3 + k][lane];
            }
            part.index = node.child[lane] & ~LEAF;
            part.kind = (node.child[lane] & LEAF) != 0 ? Part::Kind::block : Part::Kind::node;
            part.of_slivers = parent.of_slivers;
        }
        return children;
    }
    for (const std::uint32_t triangle : tree.triangle_blocks[parent.index].triangle) {
        if (triangle == NONE || shape.is_flat(triangle)) continue;
        Part& part = children.part[children.count++];
        const auto [u, v, w] = shape.mesh.triangles[triangle];
        const Corners corner{shape.file_vertex(u) - shape.centre, shape.file_vertex(v) - shape.centre,
                             shape.file_vertex(w) - shape.centre};
        const Vec3 low = least(corner[0], least(corner[1], corner[2]));
        const Vec3 high = most(corner[0], most(corner[1], corner[2]));
        constexpr float far = std::numeric_limits<float>::infinity();
        for (std::size_t k = 0; k < 3; ++k) {
            part.low[k] = std::nextafter(static_cast<float>(axis(low, k)), -far);
            part.high[k] = std::nextafter(static_cast<float>(axis(high, k)), far);
        }
        part.index = triangle;
        part.kind = Part::Kind::triangle;
        part.of_slivers = parent.of_slivers;
    }
    return children;
}

using Matrix = std::array<double, 9>;

Matrix absolute(Matrix m) {
    for (double& x : m) x = std::fabs(x);
    return m;
}
/// How fast the axes of a box move that is turned so: spin x each of them.
Matrix turning(const Vec3& spin, const Matrix& r) {
    Matrix rates;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 rate = cross(spin, {r[k], r[3 + k], r[6 + k]});
        rates[k] = rate.x;
        rates[3 + k] = rate.y;
        rates[6 + k] = rate.z;
    }
    return rates;
}

/// Where a box is in a frame that it moves past, and how fast; half: more than that no point of it differs.
struct PassingBox {
    Vec3 middle, half, rate, half_rate;
};

/// Puts boxes of one shape into the frame of the other at a moment.
class Passing {
public:
    Passing(const Pose& into, const Twist& twist)
        : into_(into), twist_(twist), reach_(absolute(into.rotation)),
          rate_reach_(absolute(turning(twist.spin, into.rotation))) {}

    PassingBox operator()(const Vec3& middle, const Vec3& half) const {
        const Vec3 at = transform_point(into_, middle);
        return {at, rotated(reach_, half), twist_.at(at), rotated(rate_reach_, half)};
    }

private:
    Pose into_;
    Twist twist_;
    Matrix reach_, rate_reach_;
};

/// Of the axes of a frame, and of any direction.
struct FrameAcross {
    std::array<MovingPair::Across, 3> axis;
    MovingPair::Across any;

    FrameAcross(const MovingPair& pair, Side frame, const MovingPair::Moment& moment) : any(pair.most_across(frame)) {
        constexpr std::array axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
        for (std::size_t k = 0; k < 3; ++k)
            axis[k] = pair.across(axes[k], moment.seen_in(frame).spin, pair.spin_of(frame));
    }
};

/// After how long a passing box may be within `near` of one that rests in the frame. Any axis that keeps them apart
/// does, and so does the direction in which they are apart: where `near` is more than next to nothing, that sees more.
double time_until_near(const PassingBox& passing, const Vec3& middle, const Vec3& half, const Nearness& near,
                       const MovingPair::Rate& bend, const FrameAcross& across) {
    double longest = 0, square = 0, shrinking = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double off = axis(passing.middle, k) - axis(middle, k), sign = off < 0 ? -1 : 1;
        const double gap = sign * off - axis(passing.half, k) - axis(half, k);
        if (!(gap > 0)) continue;
        const double rate = sign * axis(passing.rate, k) - axis(passing.half_rate, k);
        longest = std::max(longest, time_until(gap - near.aim(), rate, bend.along(across.axis[k])));
        square += gap * gap;
        shrinking += gap * rate;
    }
    if (near.distance > 0 && square > 0) {
        const double gap = std::sqrt(square);
        longest = std::max(longest, time_until(gap - near.aim(), shrinking / gap, bend.along(across.any)));
    }
    return longest;
}

/// A gap, how fast it grows and how fast that does, along one direction; and the most that this and its change can be.
struct Gap {
    double metres, rate, change, most, more;
};
/// The same of a gap of which more is known; until a horizon, at most. One that shrinks, but less and less, may pass
/// its least width before its change has changed much.
double time_until_gone(const Gap& gap, double horizon) {
    const double time = time_until(gap.metres, gap.rate, std::min(gap.most, gap.more * horizon - gap.change));
    const double square = gap.change * gap.change + 2 * gap.more * gap.rate;
    if (time >= horizon || !(gap.rate < 0 && gap.change > 0 && square > 0)) return time;
    const double root = std::sqrt(square), least = -2 * gap.rate / (gap.change + root);
    const double width = gap.metres + least * (gap.rate + least * (gap.change / 2 - least * gap.more / 6));
    return gap.metres > 0 && width > 0 ? std::max(time, (gap.change + root) / gap.more) : time;
}

/// At right angles to both edges, on the side of `way`; of parallel ones what of `way` is at right angles to the
/// longer.
Vec3 away_from_edges(const Vec3& way, const Vec3& a, const Vec3& b) {
    const Vec3 normal = cross(a, b);
    if (dot(normal, normal) > 1e-12 * dot(a, a) * dot(b, b)) return (dot(normal, way) < 0 ? -1.0 : 1.0) * unit(normal);
    const Vec3 edge = dot(a, a) > dot(b, b) ? unit(a) : unit(b);
    return unit(way - dot(way, edge) * edge);
}

/// Looks at the pair of parts that may be near first, at the time when they may: parts are opened, and triangles go on
/// to the next time at which they may be near, until two of them are (conservative advancement, Mirtich 1996, by the
/// motion along a direction of each pair's own, as Tang et al. 2009). What is never looked at meets later, or not.
class Search {
public:
    Search(const MovingPair& pair, const Nearness& near, double begin, double end)
        : pair_(pair), near_(near), end_(end) {
        moment_.emplace(pair.at(begin));
        const auto root = [](const TriangleTree& tree, bool of_slivers) {
            const Box box = box_of(tree, {0, NONE});
            Part part;
            for (std::size_t k = 0; k < 3; ++k) {
                part.low[k] = static_cast<float>(axis(box.low, k)); // it is one of float32
                part.high[k] = static_cast<float>(axis(box.high, k));
            }
            part.of_slivers = of_slivers;
            return part;
        };
        const ShapeData &a = moment_->pair.a(), &b = moment_->pair.b().shape();
        for (const bool slivers_a : {false, true})
            for (const bool slivers_b : {false, true}) {
                const TriangleTree &tree_a = slivers_a ? a.slivers : a, &tree_b = slivers_b ? b.slivers : b;
                if (tree_a.nodes.empty() || tree_b.nodes.empty()) continue;
                waiting_.push_back({begin, root(tree_a, slivers_a), root(tree_b, slivers_b)});
            }
    }

    std::optional<Meeting> operator()() {
        const InterruptionCheck check;
        while (!waiting_.empty()) {
            check();
            std::ranges::pop_heap(waiting_, later);
            const Waiting next = waiting_.back();
            waiting_.pop_back();
            if (next.time != moment_->time) moment_.emplace(pair_.at(next.time));
            if (next.a.kind != Part::Kind::triangle || next.b.kind != Part::Kind::triangle)
                open(next);
            else if (const auto met = advance(next))
                return met;
        }
        return std::nullopt;
    }

private:
    struct Waiting {
        double time;
        Part a, b;
    };
    // Of pairs at the same time those that are nearer to triangles come first.
    static bool later(const Waiting& first, const Waiting& second) {
        if (first.time != second.time) return first.time > second.time;
        const auto level = [](const Waiting& w) { return int(w.a.kind) + int(w.b.kind); };
        return level(first) > level(second);
    }

    void wait(double time, const Part& a, const Part& b) {
        if (!(time <= end_)) return;
        waiting_.push_back({time, a, b});
        std::ranges::push_heap(waiting_, later);
    }

    // The larger part is opened; its children wait until they may be near the other.
    void open(const Waiting& pair) {
        const bool opens_a = pair.b.kind == Part::Kind::triangle
                             || (pair.a.kind != Part::Kind::triangle && pair.a.size() >= pair.b.size());
        const Side side = opens_a ? Side::a : Side::b, others = opens_a ? Side::b : Side::a;
        const Part& other = opens_a ? pair.b : pair.a;
        const Vec3 other_middle = other.middle(), other_half = other.half();
        const Passing into_other(moment_->pair.out_of(side), moment_->seen_in(others));
        const PassingBox passing_other =
            Passing(moment_->pair.out_of(others), moment_->seen_in(side))(other_middle, other_half);
        const MovingPair::Rate other_bend = pair_.bend(others, other_middle, length(other_half)).change;
        const FrameAcross in_own(pair_, side, *moment_), in_others(pair_, others, *moment_);
        const Children children =
            children_of(opens_a ? moment_->pair.a() : moment_->pair.b().shape(), opens_a ? pair.a : pair.b);
        for (std::size_t i = 0; i < children.count; ++i) {
            const Part& child = children.part[i];
            const Vec3 middle = child.middle(), half = child.half();
            const MovingPair::Rate bend = pair_.bend(side, middle, length(half)).change;
            const double time =
                moment_->time
                + std::max(time_until_near(into_other(middle, half), other_middle, other_half, near_, bend, in_others),
                           time_until_near(passing_other, middle, half, near_, other_bend, in_own));
            if (opens_a)
                wait(time, child, other);
            else
                wait(time, other, child);
        }
    }

    /// A corner of a triangle, in the centred frame of b, and how it moves in the frame of the other.
    struct Corner {
        Vec3 place, velocity, change;
    };
    struct Moving {
        std::array<Corner, 3> corner;
        MovingPair::Bend bend; ///< of any corner
    };
    Moving moving(Side side, const Part& part, const Corners& corners) const {
        Moving moving{{}, pair_.bend(side, part.middle(), length(part.half()))};
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 passing = moment_->seen_in_b.at(corners[k]);
            moving.corner[k] = {corners[k], side == Side::a ? passing : Vec3{} - passing,
                                moment_->change(side, corners[k])};
        }
        return moving;
    }

    /// Two triangles seen along a direction from a to b, which stays with either of them: the gap is that of a corner
    /// each.
    struct Along {
        double gap = never, until = never;
    };
    Along along(const Vec3& way, const Moving& a, const Moving& b) const {
        Along seen;
        double first = -never, last = never; // of a and of b
        for (std::size_t k = 0; k < 3; ++k) {
            first = std::max(first, dot(way, a.corner[k].place));
            last = std::min(last, dot(way, b.corner[k].place));
        }
        seen.gap = last - first;
        // Of a's corners where the direction rests in the frame of b, and the other way round.
        const auto until = [&](const Moving& moving, std::size_t k, double gap, double sign,
                               const MovingPair::Across& across) {
            const Corner& corner = moving.corner[k];
            return time_until_gone({gap - near_.aim(), sign * dot(way, corner.velocity), sign * dot(way, corner.change),
                                    moving.bend.change.along(across), moving.bend.of_change.along(across)},
                                   end_ - moment_->time);
        };
        const Vec3& spin = moment_->seen_in_b.spin;
        const MovingPair::Across in_b = pair_.across(way, spin, moment_->spin_b),
                                 in_a = pair_.across(way, spin, moment_->spin_a);
        double until_a = never, until_b = never;
        for (std::size_t k = 0; k < 3; ++k) {
            until_a = std::min(until_a, until(a, k, last - dot(way, a.corner[k].place), -1, in_b));
            until_b = std::min(until_b, until(b, k, dot(way, b.corner[k].place) - first, 1, in_a));
        }
        seen.until = std::max(until_a, until_b);
        return seen;
    }

    std::optional<Meeting> advance(const Waiting& pair) {
        const Corners a = moment_->pair.corners_of_a(pair.a.index), b = moment_->pair.corners_of_b(pair.b.index);
        const Face face_a(a), face_b(b);
        const Moving moving_a = moving(Side::a, pair.a, a), moving_b = moving(Side::b, pair.b, b);
        Along seen{-never, 0};
        const auto look = [&](const Vec3& way) {
            if (way == Vec3{}) return;
            const Along one = along(way, moving_a, moving_b);
            seen = {std::max(seen.gap, one.gap), std::max(seen.until, one.until)};
        };
        const Vec3 across = (b[0] + b[1] + b[2]) - (a[0] + a[1] + a[2]);
        for (const Face* face : {&face_a, &face_b}) {
            look((dot(face->normal, across) < 0 ? -1.0 : 1.0) * unit(face->normal));
            if (moment_->time + seen.until > end_) return std::nullopt;
        }
        Span span;
        shorten_between(span, face_a, face_b);
        const Vec3 way = unit(span.b - span.a);
        look(way);
        // Of points next to each other the way between them is rounded, which far corners multiply.
        const double most = near_.distance + near_.tolerance;
        if (seen.gap <= most && seen.gap < std::sqrt(span.squared) - 0.01 * near_.tolerance)
            for (const Vec3& edge_a : face_a.edge)
                for (const Vec3& edge_b : face_b.edge) look(away_from_edges(way, edge_a, edge_b));
        if (seen.gap <= most) return Meeting{moment_->time, pair.a.index, pair.b.index, span.a, span.b};
        wait(std::max(moment_->time + seen.until, std::nextafter(moment_->time, never)), pair.a, pair.b);
        return std::nullopt;
    }

    const MovingPair& pair_;
    Nearness near_;
    double end_;
    std::optional<MovingPair::Moment> moment_;
    std::vector<Waiting> waiting_; ///< a heap, the first time on top
};

} // namespace

std::optional<Meeting> first_meeting(const MovingPair& pair, const Nearness& near, double begin, double end) {
    const auto searches =
        static_cast<std::uint64_t>(std::max(1.0, std::ceil((end - begin) * pair.turning() / most_turn)));
    double from = begin;
    for (std::uint64_t number = 1; number <= searches; ++number) {
        const double to = number == searches ? end : begin + (end - begin) * (double(number) / double(searches));
        if (const auto found = Search(pair, near, from, to)()) return found;
        from = to;
    }
    return std::nullopt;
}

} // namespace raycontact
