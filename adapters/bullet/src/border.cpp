// SPDX-License-Identifier: Apache-2.0
#include <border.h>
#include <vectors.h>

#include <raycontact/pose.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace raycontact::bullet {

namespace {

/// A face of the convex shape: outside of it n x > offset.
struct Face {
    Vec3 normal; ///< unit
    double offset;

    double height(const Vec3& x) const { return dot(normal, x) - offset; }
};

void faces_of(const Shape& convex, std::vector<Face>& faces) {
    faces.clear();
    const auto area = [&](std::uint32_t t) {
        const auto& [i, j, k] = convex.triangles()[t];
        const Vec3 a = convex.vertices()[i];
        return cross(convex.vertices()[j] - a, convex.vertices()[k] - a);
    };
    for (std::uint32_t t = 0; t < convex.triangles().size(); ++t) {
        const Vec3 own = area(t);
        if (!(length2(own) > 0)) continue;
        const Vec3 n = (1 / length(own)) * own;
        const auto is_known = [&](std::uint32_t other) { // by a triangle beside it
            return other < t && dot(area(other), n) > (1 - 1e-12) * length(area(other)) && length2(area(other)) > 0;
        };
        if (std::ranges::none_of(convex.neighbours()[t], is_known))
            faces.push_back({n, dot(n, convex.vertices()[convex.triangles()[t][0]])});
    }
}

/// As of other speculative contacts, whose header is not public.
constexpr double glancing = 0.25;
constexpr int halvings = 24;

/// Ends of an edge, in the frame of the convex shape.
using Ends = std::array<Vec3, 2>;

Vec3 point_at(const Ends& ends, double part) {
    return ends[0] + part * (ends[1] - ends[0]);
}

/// Of an edge, in parts of it.
using Part = std::array<double, 2>;

/// What is below all faces, or above by no more than the margin.
std::optional<Part> part_inside(const std::vector<Face>& faces, const Ends& ends, double margin) {
    double from = 0, to = 1;
    for (const Face& face : faces) {
        const double one = face.height(ends[0]) - margin, two = face.height(ends[1]) - margin;
        if (one > 0 && two > 0) return std::nullopt;
        if (one > 0) from = std::max(from, one / (one - two));
        if (two > 0) to = std::min(to, one / (one - two));
    }
    if (from > to) return std::nullopt;
    return Part{from, to};
}

/// An edge where it is in the convex shape, or first comes into it.
struct Meeting {
    Ends ends;
    Part part;
    double when; ///< part of the step
};

/// Its ends go straight from `now` to `next`, in so many steps that none passes the shape.
std::optional<Meeting> first_inside(const std::vector<Face>& faces, const Ends& now, const Ends& next, int steps) {
    const auto at = [&](double when) {
        return Ends{now[0] + when * (next[0] - now[0]), now[1] + when * (next[1] - now[1])};
    };
    if (const auto part = part_inside(faces, now, 0)) return Meeting{now, *part, 0};
    double outside = 0, inside = 0;
    for (int i = 1; i <= steps && inside == 0; ++i)
        (part_inside(faces, at(double(i) / steps), 0) ? inside : outside) = double(i) / steps;
    if (inside == 0) return std::nullopt;
    for (int i = 0; i < halvings; ++i) {
        const double when = (outside + inside) / 2;
        (part_inside(faces, at(when), 0) ? inside : outside) = when;
    }
    return Meeting{at(inside), *part_inside(faces, at(inside), 0), inside};
}

/// The face by which a point leaves: the nearest, or one no farther than the margin that the motion passes far less. So
/// a step lower than the margin is no wall.
const Face& way_out(const std::vector<Face>& faces, const Vec3& there, const Vec3& then, double margin) {
    const Face* best = &*std::ranges::max_element(faces, {}, [&](const Face& f) { return f.height(there); });
    double passed = -glancing * best->height(then);
    for (const Face& f : faces)
        if (f.height(there) >= -margin && -f.height(then) < passed) {
            passed = -f.height(then);
            best = &f;
        }
    return *best;
}

/// The shortest edge of its box, metres.
double size_across(const Leaf& leaf) {
    const Vec3 &low = leaf.converted.shape->box_min(), &high = leaf.converted.shape->box_max();
    return std::min({high.x - low.x, high.y - low.y, high.z - low.z});
}

} // namespace

void border_contacts(const Leaf& convex, const Leaf& mesh, std::span<const std::uint32_t> edges, double margin,
                     std::vector<BorderContact>& found) {
    static thread_local std::vector<Face> faces;
    found.clear();
    faces_of(*convex.converted.shape, faces);
    const Shape& shape = *mesh.converted.shape;
    const Pose in_world = to_pose(convex.pose), to_now = relative_pose(in_world, to_pose(mesh.pose)),
               to_next = relative_pose(to_pose(convex.next), to_pose(mesh.next));
    // It moves by no more than half of itself in one, up to 16 times its size.
    const double half = std::max(size_across(convex) / 2, 1e-9), way = double(convex.way + mesh.way);
    const int steps = static_cast<int>(std::clamp(std::ceil(way / half), 1.0, 32.0));
    for (const std::uint32_t number : edges) {
        const std::uint32_t t = number / 3, k = number % 3;
        const Vec3 &a = shape.vertices()[shape.triangles()[t][k]],
                   &b = shape.vertices()[shape.triangles()[t][(k + 1) % 3]];
        const Ends now{transform_point(to_now, a), transform_point(to_now, b)},
            next{transform_point(to_next, a), transform_point(to_next, b)};
        auto meeting = first_inside(faces, now, next, steps);
        const bool is_inside = meeting && meeting->when == 0;
        if (!meeting)
            if (const auto near = part_inside(faces, now, margin)) meeting = Meeting{now, *near, 0};
        if (!meeting) continue;
        const auto& [ends, part, when] = *meeting;
        const double middle = (part[0] + part[1]) / 2;
        const Face& face = way_out(faces, point_at(ends, middle), point_at(next, middle), margin);
        const auto edge = static_cast<int>(3 * shape.triangle_index()[t] + k);
        for (const int end : {0, 1}) {
            const Vec3 x = point_at(now, part[static_cast<std::size_t>(end)]);
            const double height = face.height(x); // of what is outside an end may be below this face, by another's
            found.push_back({edge, end, to_bullet(transform_point(in_world, x)),
                             to_bullet(turned(in_world, face.normal)),
                             btScalar(is_inside ? height : std::max(0.0, height))});
        }
    }
}

} // namespace raycontact::bullet
